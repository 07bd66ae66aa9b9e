// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// The document and its layers, under the names that all supported versions of MeshLab share.
#if __has_include(<common/ml_document/mesh_document.h>)
#include <common/ml_document/mesh_document.h>
#else
#include <common/meshmodel.h>
#endif

namespace orthopoly {

/// Calls function(const MeshModel&) for every layer, in the order of the document.
template<class Function>
void for_each_layer(const MeshDocument& document, const Function& function)
{
#if __has_include(<common/ml_document/mesh_document.h>)
	for (const MeshModel& layer : document.meshIterator())
		function(layer);
#else
	for (const MeshModel* layer : document.meshList)
		function(*layer);
#endif
}

} // namespace orthopoly
