# SPDX-License-Identifier: GPL-3.0-or-later
# The part of the core that includes vcglib, built once for each vcglib tree in use.

# add_orthopoly_vcg(TARGET VCGLIB_DIR)
#
# A static library of mesh_io.cpp against one vcglib tree. vcglib is inline code
# whose layout differs between versions, so two versions of it must never meet in one binary.
function(add_orthopoly_vcg TARGET VCGLIB)
	if(NOT EXISTS "${VCGLIB}/vcg/complex/complex.h")
		message(FATAL_ERROR "${VCGLIB} is not a vcglib tree: vcg/complex/complex.h is not in it")
	endif()
	set(core "${PROJECT_SOURCE_DIR}/vcg_core")
	add_library(${TARGET} STATIC "${core}/mesh_io.cpp")
	target_include_directories(${TARGET} SYSTEM PUBLIC "${VCGLIB}")
	target_link_libraries(${TARGET} PUBLIC orthopoly_core)
	orthopoly_warnings(${TARGET} CONVERSION)

	# vcglib's own PLY reader, with the warnings it has.
	add_library(${TARGET}_ply STATIC "${VCGLIB}/wrap/ply/plylib.cpp")
	target_include_directories(${TARGET}_ply SYSTEM PUBLIC "${VCGLIB}")
	target_link_libraries(${TARGET}_ply PUBLIC Eigen3::Eigen)
	target_compile_options(${TARGET}_ply PRIVATE -w)
	target_link_libraries(${TARGET} PRIVATE ${TARGET}_ply)
endfunction()

# set_default_vcglib()
#
# Sets VCGLIB_DIR in the caller to the vcglib of the newest MeshLab tree where the user gave none.
function(set_default_vcglib)
	if(NOT VCGLIB_DIR)
		if(NOT MESHLAB_TREES)
			message(FATAL_ERROR
				"No vcglib: give -DVCGLIB_DIR=<vcglib tree> for the core, the command and the tests, "
				"or -DMESHLAB_SOURCE_DIR=<MeshLab source tree> to build the plugin too")
		endif()
		list(GET MESHLAB_TREES -1 newest)
		set(VCGLIB_DIR "${MESHLAB_${newest}_VCGLIB}")
	endif()
	get_filename_component(VCGLIB_DIR "${VCGLIB_DIR}" ABSOLUTE BASE_DIR "${CMAKE_BINARY_DIR}")
	message(STATUS "vcglib of the command and the tests: ${VCGLIB_DIR}")
	set(VCGLIB_DIR "${VCGLIB_DIR}" PARENT_SCOPE)
endfunction()
