# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DPLUGIN=FILE -DNM=nm -P check_plugin_symbols.cmake: fails where a plugin leaves open a symbol
# that no host can bring.
execute_process(
	COMMAND "${NM}" -D -C --undefined-only "${PLUGIN}"
	OUTPUT_VARIABLE symbols RESULT_VARIABLE failed)
if(failed)
	message(FATAL_ERROR "${NM} cannot read ${PLUGIN}")
endif()
string(REGEX MATCHALL "[^\n]*orthopoly[^\n]*" ours "${symbols}")
string(REGEX MATCHALL "[^\n]* (gl[A-Z]|__glew|omp_|GOMP_)[^\n]*" foreign "${symbols}")
if(ours OR foreign)
	list(JOIN ours "\n" ours)
	list(JOIN foreign "\n" foreign)
	file(REMOVE "${PLUGIN}")
	message(FATAL_ERROR "${PLUGIN} needs symbols that no host has:\n${ours}\n${foreign}")
endif()
