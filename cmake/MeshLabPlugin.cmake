# SPDX-License-Identifier: GPL-3.0-or-later
# A plugin for one host: one MeshLab tree, one scalar.

set(MESHLAB_PLUGIN_MODULE_DIR "${CMAKE_CURRENT_LIST_DIR}")

# What follows is of the linker and the library format there.
if(NOT CMAKE_SYSTEM_NAME STREQUAL "Linux")
	message(FATAL_ERROR
		"The plugin can be built for MeshLab on Linux only. Without MESHLAB_SOURCE_DIR, "
		"-DVCGLIB_DIR=<vcglib tree> builds the library and the command")
endif()

# An empty library with the name of MeshLab's own, to link against. The plugin has to name it as
# needed (pymeshlab loads plugins with local symbols), while the host brings the real one.
function(add_meshlab_common_stub)
	if(TARGET meshlab_common_stub)
		return()
	endif()
	set(source "${CMAKE_BINARY_DIR}/meshlab_common_stub/empty.cpp")
	if(NOT EXISTS "${source}")
		file(WRITE "${source}" "// Nothing: see cmake/MeshLabPlugin.cmake.\n")
	endif()
	add_library(meshlab_common_stub SHARED "${source}")
	set_target_properties(meshlab_common_stub PROPERTIES
		OUTPUT_NAME meshlab-common
		LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/meshlab_common_stub")
endfunction()

# meshlab_host_name(VERSION SCALAR OUTPUT)
#
# meshlab-2025.07 for float; for double pymeshlab-2025.7, as the Python package writes its versions.
function(meshlab_host_name VERSION SCALAR OUTPUT)
	if(SCALAR STREQUAL "double")
		string(REGEX REPLACE "\\.0+([0-9])" ".\\1" version "${VERSION}")
		set(${OUTPUT} "pymeshlab-${version}" PARENT_SCOPE)
	else()
		set(${OUTPUT} "meshlab-${VERSION}" PARENT_SCOPE)
	endif()
endfunction()

# add_orthopoly_plugin(HOST TREE SCALAR SOURCE...)
#
# Builds <build>/plugins/<HOST>/libfilter_orthopoly.so against the MeshLab version TREE (one that
# find_meshlab_trees() found) with MESHLAB_SCALAR set to SCALAR, float or double.
function(add_orthopoly_plugin HOST TREE SCALAR)
	find_package(Qt5 5.12 REQUIRED COMPONENTS Core Gui Widgets Xml OpenGL)
	add_meshlab_common_stub()

	set(vcg "orthopoly_vcg_${TREE}")
	if(NOT TARGET ${vcg})
		add_orthopoly_vcg(${vcg} "${MESHLAB_${TREE}_VCGLIB}")
	endif()

	# MeshLab composes its version so: the host refuses a plugin whose version or scalar is another.
	set(version "${TREE}")
	if(SCALAR STREQUAL "double")
		string(APPEND version "d")
	endif()

	set(target "filter_orthopoly_${HOST}")
	add_library(${target} MODULE ${ARGN})
	set_target_properties(${target} PROPERTIES
		AUTOMOC ON
		OUTPUT_NAME filter_orthopoly
		LIBRARY_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/plugins/${HOST}"
		# No path of this build in the plugin: the libraries are those its host has loaded.
		SKIP_BUILD_RPATH ON
		INSTALL_RPATH "")
	target_compile_definitions(${target} PRIVATE
		MESHLAB_VERSION=${version}
		MESHLAB_SCALAR=${SCALAR}
		ORTHOPOLY_VERSION="${PROJECT_VERSION}")
	target_include_directories(${target} PRIVATE "${PROJECT_SOURCE_DIR}/filter_orthopoly")
	target_include_directories(${target} SYSTEM PRIVATE
		"${MESHLAB_${TREE}_SOURCE}" "${MESHLAB_${TREE}_VCGLIB}")
	orthopoly_warnings(${target})

	# Only Qt's two entry points leave the plugin: its copies of vcglib's inline code stay its own.
	set(exports "${MESHLAB_PLUGIN_MODULE_DIR}/plugin_exports.map")
	add_dependencies(${target} meshlab_common_stub)
	target_link_libraries(${target} PRIVATE
		orthopoly_core ${vcg} Qt5::Core Qt5::Gui Qt5::Widgets Qt5::Xml Qt5::OpenGL
		-Wl,--push-state,--no-as-needed $<TARGET_FILE:meshlab_common_stub> -Wl,--pop-state)
	target_link_options(${target} PRIVATE
		-Wl,--as-needed -Wl,--unresolved-symbols=ignore-all -Wl,--version-script=${exports})
	set_property(TARGET ${target} APPEND PROPERTY LINK_DEPENDS "${exports}")

	# The linker was told to leave symbols open, so a function of ours that is missing has to be
	# found here rather than by the first user.
	add_custom_command(TARGET ${target} POST_BUILD
		COMMAND "${CMAKE_COMMAND}" -DPLUGIN=$<TARGET_FILE:${target}> -DNM=${CMAKE_NM}
			-P "${MESHLAB_PLUGIN_MODULE_DIR}/check_plugin_symbols.cmake"
		VERBATIM)
endfunction()
