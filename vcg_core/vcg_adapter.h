// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "errors.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vcg/complex/complex.h>
#include <vector>
#include <wrap/callback.h>

namespace orthopoly {

/// Which vertices of a VCG mesh may move.
enum class VcgRegion {
	All,
	/// Those that have faces, all of them selected: what vcglib calls VertexFromFaceStrict. The
	/// selection of the vertices themselves plays no part.
	SelectedFaces,
};

/// A VCG mesh read into flat arrays, and the way back to its own elements.
struct VcgArrays {
	TriangleMesh mesh;
	/// #V places in the VCG mesh's `vert`; deleted vertices are left out.
	std::vector<std::size_t> vertices;
	/// #F places in the VCG mesh's `face`; deleted faces are left out.
	std::vector<std::size_t> faces;
	Index selected_faces = 0;
	/// Vertices that may move.
	Index free_vertices = 0;
};

namespace vcg_adapter {

// Place of a face's corner in `vert`; throws where the face points outside it.
template<class VcgMesh>
std::size_t corner_place(const VcgMesh& mesh, std::size_t face, int corner)
{
	const auto* vertex = mesh.face[face].cV(corner);
	// Pointers into another array (a mesh copied carelessly) are refused as well.
	const bool inside = vertex != nullptr && !mesh.vert.empty() && !(vertex < &mesh.vert.front()) &&
						!(&mesh.vert.back() < vertex);
	if (!inside || vertex->IsD())
		throw InvalidMesh(
			"face " + std::to_string(face) + " has a corner that is none of the mesh's " +
			std::to_string(mesh.VN()) + " vertices; repair or remove that face first");
	return static_cast<std::size_t>(vertex - &mesh.vert.front());
}

// A vertex is free once one of its faces is selected and none is not.
template<class VcgMesh>
void fix_outside_selection(const VcgMesh& mesh, VcgArrays& arrays)
{
	std::vector<std::uint8_t> touches_selected(arrays.vertices.size(), 0);
	std::vector<std::uint8_t> touches_other(arrays.vertices.size(), 0);
	for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
		std::vector<std::uint8_t>& touches =
			mesh.face[arrays.faces[i]].IsS() ? touches_selected : touches_other;
		for (const Index vertex : arrays.mesh.faces[i])
			touches[static_cast<std::size_t>(vertex)] = 1;
	}
	arrays.mesh.fixed.assign(arrays.vertices.size(), 1);
	arrays.free_vertices = 0;
	for (std::size_t i = 0; i < arrays.vertices.size(); ++i) {
		if (touches_selected[i] && !touches_other[i]) {
			arrays.mesh.fixed[i] = 0;
			++arrays.free_vertices;
		}
	}
}

} // namespace vcg_adapter

/// Reads any VCG mesh of triangles; it is not changed. Vertices outside the region become fixed.
///
/// Throws InvalidMesh where a face has a corner that is deleted or belongs to another mesh.
template<class VcgMesh>
VcgArrays read_vcg_mesh(const VcgMesh& mesh, VcgRegion region = VcgRegion::All)
{
	constexpr Index DELETED = -1;
	VcgArrays arrays;
	std::vector<Index> numbers(mesh.vert.size(), DELETED);
	arrays.mesh.positions.reserve(mesh.vert.size());
	arrays.vertices.reserve(mesh.vert.size());
	for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
		if (mesh.vert[i].IsD())
			continue;
		numbers[i] = arrays.mesh.vertex_count();
		const auto& position = mesh.vert[i].cP();
		arrays.mesh.positions.emplace_back(
			static_cast<double>(position[0]),
			static_cast<double>(position[1]),
			static_cast<double>(position[2]));
		arrays.vertices.push_back(i);
	}
	arrays.mesh.faces.reserve(mesh.face.size());
	arrays.faces.reserve(mesh.face.size());
	for (std::size_t i = 0; i < mesh.face.size(); ++i) {
		if (mesh.face[i].IsD())
			continue;
		Face face;
		for (int k = 0; k < 3; ++k)
			face[static_cast<std::size_t>(k)] = numbers[vcg_adapter::corner_place(mesh, i, k)];
		arrays.mesh.faces.push_back(face);
		arrays.faces.push_back(i);
		arrays.selected_faces += mesh.face[i].IsS() ? 1 : 0;
	}
	arrays.free_vertices = arrays.mesh.vertex_count();
	if (region == VcgRegion::SelectedFaces)
		vcg_adapter::fix_outside_selection(mesh, arrays);
	return arrays;
}

/// Writes positions (#V, the order of `arrays`) into the mesh the arrays were read from.
///
/// A vertex whose position is the one that was read is not touched, so that it stays as it was bit
/// for bit. Normals and bounding box are the caller's to bring up to date.
template<class VcgMesh>
void write_positions(VcgMesh& mesh, const VcgArrays& arrays, const std::vector<Point>& positions)
{
	using Scalar = typename VcgMesh::ScalarType;
	for (std::size_t i = 0; i < arrays.vertices.size(); ++i) {
		if (positions[i] == arrays.mesh.positions[i])
			continue;
		auto& target = mesh.vert[arrays.vertices[i]].P();
		for (int k = 0; k < 3; ++k)
			target[k] = static_cast<Scalar>(positions[i][k]);
	}
}

/// Progress that goes to a callback as vcglib's algorithms take it. The callback's `false` stops
/// the work. May be null.
inline Progress vcg_progress(vcg::CallBackPos* callback)
{
	if (callback == nullptr)
		return Progress();
	return Progress([callback](int percent, const std::string& words) {
		return callback(percent, words.c_str());
	});
}

/// Denoises a VCG mesh of triangles in place, with any vertex type that has coordinates.
///
/// Only coordinates change, and only at the end: where the callback stops the work (the status then
/// is Cancelled) or an exception is thrown, the mesh is as it was. Normals and bounding box are the
/// caller's to bring up to date. Throws as `denoise` of flat arrays does, and InvalidMesh as
/// `read_vcg_mesh` does.
template<class VcgMesh, class = std::enable_if_t<!std::is_same_v<VcgMesh, TriangleMesh>>>
DenoiseResult denoise(
	VcgMesh& mesh,
	const DenoiseOptions& options,
	vcg::CallBackPos* callback = nullptr,
	VcgRegion region = VcgRegion::All)
{
	const VcgArrays arrays = read_vcg_mesh(mesh, region);
	Progress progress = vcg_progress(callback);
	DenoiseResult result = denoise(arrays.mesh, options, progress);
	if (result.status == DenoiseResult::Status::Done)
		write_positions(mesh, arrays, result.positions);
	return result;
}

} // namespace orthopoly
