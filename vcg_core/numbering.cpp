// SPDX-License-Identifier: GPL-3.0-or-later
#include "numbering.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace orthopoly {

namespace {

// Cells along an axis: finer than the faces of any mesh that fits into memory.
constexpr int BITS = 16;

// The leading bits of an index that say which bucket it is sorted in.
constexpr int BUCKET_BITS = 12;

constexpr Index GRAIN = 4096;

struct Key {
	std::uint64_t place;
	Index face;

	bool operator<(const Key& other) const
	{
		return place != other.place ? place < other.place : face < other.face;
	}
};

// The place of every face on the curve.
std::vector<Key> keys_of(const TriangleMesh& mesh, Execution& execution)
{
	// Of the faces: a stray vertex far off would leave them all in one cell.
	Point low = mesh.positions[at(mesh.faces.front().front())];
	Point high = low;
	for (const Face& face : mesh.faces) {
		for (const Index vertex : face) {
			low = low.cwiseMin(mesh.positions[at(vertex)]);
			high = high.cwiseMax(mesh.positions[at(vertex)]);
		}
	}
	const double extent = (high - low).maxCoeff();
	const double cells = std::ldexp(1.0, BITS);
	const double scale = extent > 0 ? cells / extent : 0;
	std::vector<Key> keys(mesh.faces.size());
	execution.parallel_for(mesh.face_count(), GRAIN, [&](Index begin, Index end, int) {
		for (Index i = begin; i < end; ++i) {
			Point sum = Point::Zero();
			for (const Index vertex : mesh.faces[at(i)])
				sum += mesh.positions[at(vertex)] - low;
			std::array<std::uint32_t, 3> cell;
			for (std::size_t axis = 0; axis < 3; ++axis)
				cell[axis] = static_cast<std::uint32_t>(
					std::min(cells - 1, scale / 3 * sum[static_cast<Index>(axis)]));
			keys[at(i)] = {hilbert_index(cell, BITS), i};
		}
	});
	return keys;
}

// Sorts by buckets, so that threads have something to share, and a cancel is heard.
void sort(std::vector<Key>& keys, Execution& execution)
{
	const auto bucket_of = [](const Key& key) {
		return static_cast<std::size_t>(key.place >> static_cast<unsigned>(3 * BITS - BUCKET_BITS));
	};
	std::vector<std::size_t> offsets((1U << static_cast<unsigned>(BUCKET_BITS)) + 1, 0);
	for (const Key& key : keys)
		++offsets[bucket_of(key) + 1];
	std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
	std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
	std::vector<Key> sorted(keys.size());
	for (const Key& key : keys)
		sorted[next[bucket_of(key)]++] = key;
	execution.parallel_for(static_cast<Index>(next.size()), 1, [&](Index begin, Index end, int) {
		const auto iterator = [&](Index bucket) {
			return sorted.begin() + static_cast<std::ptrdiff_t>(offsets[at(bucket)]);
		};
		for (Index bucket = begin; bucket < end; ++bucket)
			std::sort(iterator(bucket), iterator(bucket + 1));
	});
	keys.swap(sorted);
}

} // namespace

std::uint64_t hilbert_index(std::array<std::uint32_t, 3> cell, int bits)
{
	// From the coarsest cells to the finest: the curve through the eight parts of a cell is the
	// same everywhere but turned and mirrored, which is undone in what is left of the coordinates.
	std::uint32_t parity = 0;
	for (std::uint32_t half = 1U << static_cast<unsigned>(bits - 1); half > 0; half >>= 1U) {
		const std::uint32_t finer = half - 1;
		for (std::uint32_t& coordinate : cell) {
			if ((coordinate & half) != 0) {
				cell[0] ^= finer;
			}
			else {
				const std::uint32_t difference = (cell[0] ^ coordinate) & finer;
				cell[0] ^= difference;
				coordinate ^= difference;
			}
		}
	}
	// What is left are the digits of the index in Gray code.
	cell[1] ^= cell[0];
	cell[2] ^= cell[1];
	for (std::uint32_t half = 1U << static_cast<unsigned>(bits - 1); half > 1; half >>= 1U) {
		if ((cell[2] & half) != 0)
			parity ^= half - 1;
	}
	std::uint64_t index = 0;
	for (int bit = bits - 1; bit >= 0; --bit) {
		for (const std::uint32_t coordinate : cell)
			index = index << 1U | ((coordinate ^ parity) >> static_cast<unsigned>(bit) & 1U);
	}
	return index;
}

Numbering number_by_place(const TriangleMesh& mesh, Execution& execution)
{
	Numbering numbering;
	if (!mesh.faces.empty()) {
		std::vector<Key> keys = keys_of(mesh, execution);
		sort(keys, execution);
		numbering.faces.reserve(keys.size());
		for (const Key& key : keys)
			numbering.faces.push_back(key.face);
	}
	numbering.vertices.reserve(mesh.positions.size());
	std::vector<std::uint8_t> seen(mesh.positions.size(), 0);
	const auto visit = [&](Index vertex) {
		if (seen[at(vertex)] == 0)
			numbering.vertices.push_back(vertex);
		seen[at(vertex)] = 1;
	};
	for (const Index face : numbering.faces) {
		for (const Index vertex : mesh.faces[at(face)])
			visit(vertex);
	}
	for (Index vertex = 0; vertex < mesh.vertex_count(); ++vertex)
		visit(vertex);
	return numbering;
}

Numbering same_numbering(const TriangleMesh& mesh)
{
	Numbering numbering;
	numbering.faces.resize(mesh.faces.size());
	numbering.vertices.resize(mesh.positions.size());
	std::iota(numbering.faces.begin(), numbering.faces.end(), Index(0));
	std::iota(numbering.vertices.begin(), numbering.vertices.end(), Index(0));
	return numbering;
}

TriangleMesh renumbered(const TriangleMesh& mesh, const Numbering& numbering, const Point& origin)
{
	TriangleMesh result;
	std::vector<Index> numbers(numbering.vertices.size());
	result.positions.reserve(numbers.size());
	for (const Index vertex : numbering.vertices) {
		numbers[at(vertex)] = static_cast<Index>(result.positions.size());
		result.positions.emplace_back(mesh.positions[at(vertex)] - origin);
		if (!mesh.fixed.empty())
			result.fixed.push_back(mesh.fixed[at(vertex)]);
	}
	result.faces.reserve(numbering.faces.size());
	for (const Index i : numbering.faces) {
		const Face& face = mesh.faces[at(i)];
		result.faces.push_back({numbers[at(face[0])], numbers[at(face[1])], numbers[at(face[2])]});
	}
	return result;
}

} // namespace orthopoly
