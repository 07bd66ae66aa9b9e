# SPDX-License-Identifier: GPL-3.0-or-later
# How every target of the project is compiled.

set(CMAKE_CXX_STANDARD 17)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_CXX_VISIBILITY_PRESET hidden)
set(CMAKE_VISIBILITY_INLINES_HIDDEN ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

get_property(multi_config GLOBAL PROPERTY GENERATOR_IS_MULTI_CONFIG)
if(NOT CMAKE_BUILD_TYPE AND NOT multi_config)
	set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()

# Results are the same bit for bit wherever the program is built: no fused multiply-add behind the
# source's back. There is no -march either: Eigen's alignment has to be that of the host's build.
if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
	add_compile_options(-ffp-contract=off -fno-math-errno -fno-trapping-math)
endif()

if(ORTHOPOLY_SANITIZE)
	# As an option each (a list), so that -DORTHOPOLY_SANITIZE=address,undefined stays one argument.
	add_compile_options(
		-fsanitize=${ORTHOPOLY_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all -g1
		# What these two find the address sanitizer finds as well; compiling takes half as long without.
		-fno-sanitize=null,object-size
		# The instrumented code misleads it.
		-Wno-maybe-uninitialized)
	add_link_options(-fsanitize=${ORTHOPOLY_SANITIZE})
endif()

# orthopoly_warnings(TARGET [CONVERSION])
#
# Warnings of a target of ours; CONVERSION adds the narrowing ones, wanted where the numbers are.
function(orthopoly_warnings TARGET)
	cmake_parse_arguments(PARSE_ARGV 1 ARG "CONVERSION" "" "")
	if(MSVC)
		target_compile_options(${TARGET} PRIVATE /W4 $<$<BOOL:${ORTHOPOLY_WERROR}>:/WX>)
		return()
	endif()
	target_compile_options(${TARGET} PRIVATE
		-Wall -Wextra -Wshadow
		$<$<BOOL:${ARG_CONVERSION}>:-Wconversion>
		$<$<BOOL:${ORTHOPOLY_WERROR}>:-Werror>)
endfunction()
