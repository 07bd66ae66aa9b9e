# SPDX-License-Identifier: GPL-3.0-or-later
# What a MeshLab source tree is: its version, its vcglib, its plugin interface.

# find_meshlab_trees(DIRECTORIES)
#
# Takes relative paths as from the folder of the project.
# Sets in the caller MESHLAB_TREES, the versions found from oldest to newest, and for each version
# MESHLAB_<version>_SOURCE (the folder of <common/...>), _VCGLIB and _INTERFACE (old or new).
function(find_meshlab_trees DIRECTORIES)
	set(versions "")
	foreach(tree IN LISTS DIRECTORIES)
		get_filename_component(tree "${tree}" ABSOLUTE BASE_DIR "${PROJECT_SOURCE_DIR}")
		if(NOT EXISTS "${tree}/ML_VERSION")
			message(FATAL_ERROR "${tree} is not a MeshLab source tree: ML_VERSION is not in it")
		endif()
		file(READ "${tree}/ML_VERSION" version)
		string(STRIP "${version}" version)

		if(EXISTS "${tree}/src/common/plugins/interfaces/filter_plugin.h")
			set(interface new)
		elseif(EXISTS "${tree}/src/common/interfaces.h")
			set(interface old)
		else()
			message(FATAL_ERROR
				"MeshLab ${version} in ${tree} has neither src/common/interfaces.h nor "
				"src/common/plugins/interfaces/filter_plugin.h: 2020.09 and 2021.07 or later will do")
		endif()

		set(vcglib "")
		foreach(candidate IN ITEMS "${tree}/src/vcglib" "${tree}/vcglib" "${tree}/../vcglib")
			if(EXISTS "${candidate}/vcg/complex/complex.h")
				set(vcglib "${candidate}")
				break()
			endif()
		endforeach()
		if(NOT vcglib)
			message(FATAL_ERROR
				"MeshLab ${version} in ${tree} has no vcglib: clone it with its submodules "
				"(git submodule update --init)")
		endif()

		if("${version}" IN_LIST versions)
			message(FATAL_ERROR "MESHLAB_SOURCE_DIR names two trees of MeshLab ${version}")
		endif()
		list(APPEND versions "${version}")
		set(MESHLAB_${version}_SOURCE "${tree}/src" PARENT_SCOPE)
		set(MESHLAB_${version}_VCGLIB "${vcglib}" PARENT_SCOPE)
		set(MESHLAB_${version}_INTERFACE "${interface}" PARENT_SCOPE)
		message(STATUS "MeshLab ${version}: ${tree}")
	endforeach()
	list(SORT versions COMPARE NATURAL)
	set(MESHLAB_TREES "${versions}" PARENT_SCOPE)
endfunction()
