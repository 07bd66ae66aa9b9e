// SPDX-License-Identifier: GPL-3.0-or-later
#include "shapes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace orthopoly {

namespace {

constexpr double PI = 3.14159265358979323846;

int at_least(int minimum, double value)
{
	return std::max(minimum, static_cast<int>(std::lround(value)));
}

// A number from 0 to 1 that depends on nothing but its arguments (the finaliser of MurmurHash3).
double scatter(int i, int j, int kind)
{
	std::uint64_t bits = (static_cast<std::uint64_t>(i) << 34U) ^
						 (static_cast<std::uint64_t>(j) << 4U) ^ static_cast<std::uint64_t>(kind);
	for (const std::uint64_t factor : {0xff51afd7ed558ccdU, 0xc4ceb9fe1a85ec53U}) {
		bits ^= bits >> 33U;
		bits *= factor;
	}
	bits ^= bits >> 33U;
	return static_cast<double>(bits >> 11U) * 0x1p-53;
}

// Two triangles for the square a b c d, cut along a c or along b d.
void add_square(const std::array<Index, 4>& square, bool along_ac, std::vector<Face>& faces)
{
	const auto [a, b, c, d] = square;
	if (along_ac) {
		faces.push_back({a, b, c});
		faces.push_back({a, c, d});
	}
	else {
		faces.push_back({a, b, d});
		faces.push_back({b, c, d});
	}
}

// A grid that closes on itself both ways; `irregular` cuts the squares either way.
std::vector<Face> torus_faces(int rows, int columns, bool irregular)
{
	std::vector<Face> faces;
	faces.reserve(2 * at(rows) * at(columns));
	for (int i = 0; i < rows; ++i) {
		for (int j = 0; j < columns; ++j) {
			const int below = (i + 1) % rows;
			const int right = (j + 1) % columns;
			add_square(
				{i * columns + j,
				 i * columns + right,
				 below * columns + right,
				 below * columns + j},
				!irregular || scatter(i, j, 0) < 0.5,
				faces);
		}
	}
	return faces;
}

// Numbers the points of a lattice in the order they are first asked for.
class Lattice {
public:
	explicit Lattice(std::vector<Point>& positions) : positions_(positions) {}

	Index vertex(const std::array<int, 3>& key, const Point& point)
	{
		const auto [found, is_new] = vertices_.emplace(key, static_cast<Index>(positions_.size()));
		if (is_new)
			positions_.push_back(point);
		return found->second;
	}

private:
	std::vector<Point>& positions_;
	std::map<std::array<int, 3>, Index> vertices_;
};

// The outline of the part at one place of its profile: a circle, a square, or between the two.
struct Station {
	double radius;
	// Half the side of the square.
	double half_side;
	// 0: circle, 1: square.
	double squareness;
	double height;
};

// A point of the outline, `turn` from 0 to 1; evenly spaced along the circle and along the square,
// whose corners are at odd multiples of 1/8.
Point outline_point(const Station& station, double turn)
{
	const double angle = 2 * PI * turn;
	const Point circle(std::cos(angle), std::sin(angle), 0);
	// Along the square: distance from the middle of the side, and which side.
	const double eighths = 8 * turn + 1;
	const int side = static_cast<int>(std::floor(eighths / 2)) % 4;
	const double along = eighths - 2 * std::floor(eighths / 2) - 1;
	static const std::array<std::pair<double, double>, 4> outward = {
		{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
	const auto [x, y] = outward[at(side)];
	const Point square(x - along * y, y + along * x, 0);
	Point point = (1 - station.squareness) * station.radius * circle +
				  station.squareness * station.half_side * square;
	point.z() = station.height;
	return point;
}

// The ends of the pieces of the part's profile; from one to the next, all values change evenly.
constexpr std::array<Station, 7> PART_PROFILE = {{
	{1.5, 1, 0, 0},    // lower rim of the flange
	{1.5, 1, 0, 0.06}, // upper rim
	{1.5, 1, 1, 0.06}, // foot of the block
	{0.85, 1, 1, 1},   // top of its walls
	{0.85, 1, 0, 1},   // foot of the rounded rim
	{0.55, 1, 0, 1.3}, // its top: the piece before is a quarter of a circle
	{0.55, 1, 0, 0},   // lower end of the bore
}};
constexpr std::size_t ROUNDED_PIECE = 4;
constexpr double ROUNDING = 0.3;

Station between(std::size_t piece, double t)
{
	const Station& a = PART_PROFILE[piece];
	const Station& b = PART_PROFILE[(piece + 1) % PART_PROFILE.size()];
	Station station {};
	const auto mix = [t](double from, double to) { return (1 - t) * from + t * to; };
	station.radius = mix(a.radius, b.radius);
	station.half_side = mix(a.half_side, b.half_side);
	station.squareness = mix(a.squareness, b.squareness);
	station.height = mix(a.height, b.height);
	if (piece == ROUNDED_PIECE) {
		station.radius = b.radius + ROUNDING * std::cos(t * PI / 2);
		station.height = a.height + ROUNDING * std::sin(t * PI / 2);
	}
	return station;
}

// Length of a piece of the profile, half way between a corner and the middle of a side.
double piece_length(std::size_t piece)
{
	constexpr int STEPS = 16;
	double length = 0;
	for (int i = 0; i < STEPS; ++i)
		length += (outline_point(between(piece, (i + 1.0) / STEPS), 1.0 / 16) -
				   outline_point(between(piece, static_cast<double>(i) / STEPS), 1.0 / 16))
					  .norm();
	return length;
}

// Area of the part, to find how long its edges have to be.
constexpr double PART_AREA = 32.0;
// Length of an outline of middling size.
constexpr double PART_OUTLINE = 7.0;

constexpr double FIELD_WIDTH = 2.0;
constexpr double FIELD_DEPTH = 1.5;
// What the holes and bites leave of it.
constexpr double FIELD_SHARE = 0.905;

double field_height(double x, double y)
{
	const double ground =
		0.12 * std::sin(3 * x + 0.5) * std::cos(4 * y) + 0.05 * std::sin(9 * x * y);
	const double curb = y > 0.9 + 0.15 * std::sin(4 * x) ? 0.18 : 0.0;
	return ground + curb;
}

bool is_in_field(double x, double y)
{
	const auto within = [&](double center_x, double center_y, double radius) {
		return std::hypot(x - center_x, y - center_y) < radius;
	};
	return !within(1.3, 0.5, 0.15) && !within(0, 1.5, 0.3) && !within(2.05, 0.8, 0.25) &&
		   !within(0.8, -0.1, 0.2);
}

constexpr double SHEET_SIDE = 2.0;
// Samples of a scan line to a step from line to line.
constexpr double SAMPLES_PER_LINE = 8;

// A rib with sloping flanks, then a bead of half a circle, on a sheet that bends along them.
double sheet_height(double x, double y)
{
	const double rib = std::min({0.3, std::max(0.0, 2 * (x - 0.3)), std::max(0.0, 2 * (0.9 - x))});
	const double beside = x - 1.5;
	const double bead = std::sqrt(std::max(0.0, 0.09 - beside * beside));
	return 0.1 * y * y + rib + bead;
}

} // namespace

TriangleMesh make_box(const std::array<int, 3>& counts, const Point& lengths)
{
	TriangleMesh mesh;
	Lattice lattice(mesh.positions);
	const auto vertex = [&](const std::array<int, 3>& key) {
		Point point;
		for (int axis = 0; axis < 3; ++axis)
			point[axis] =
				lengths[axis] * (static_cast<double>(key[at(axis)]) / counts[at(axis)] - 0.5);
		return lattice.vertex(key, point);
	};
	for (int axis = 0; axis < 3; ++axis) {
		const int u_axis = (axis + 1) % 3;
		const int v_axis = (axis + 2) % 3;
		for (const bool upper : {false, true}) {
			for (int u = 0; u < counts[at(u_axis)]; ++u) {
				for (int v = 0; v < counts[at(v_axis)]; ++v) {
					const auto corner = [&](int du, int dv) {
						std::array<int, 3> key {};
						key[at(axis)] = upper ? counts[at(axis)] : 0;
						key[at(u_axis)] = u + du;
						key[at(v_axis)] = v + dv;
						return vertex(key);
					};
					std::array<Index, 4> square = {
						corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
					if (!upper)
						std::swap(square[1], square[3]);
					add_square(square, true, mesh.faces);
				}
			}
		}
	}
	return mesh;
}

TriangleMesh make_cube(Index faces)
{
	const int count = at_least(1, std::sqrt(faces / 12.0));
	return make_box({count, count, count}, Point::Constant(2));
}

TriangleMesh make_thin_plate(Index faces)
{
	const int count = at_least(2, std::sqrt(faces / 4.0));
	// The thickness is a part of the edges too, a small one, so a few rounds settle it.
	double thickness = 1;
	TriangleMesh mesh;
	for (int round = 0; round < 40; ++round) {
		mesh = make_box({count, count, 1}, Point(1, 1, thickness));
		thickness = mean_edge_length(mesh.positions, mesh.faces);
	}
	return make_box({count, count, 1}, Point(1, 1, thickness));
}

TriangleMesh make_sphere(Index faces)
{
	const int frequency = at_least(1, std::sqrt(faces / 20.0));
	const double golden = (1 + std::sqrt(5.0)) / 2;
	const std::array<Point, 12> corners = {
		Point(-1, golden, 0),
		Point(1, golden, 0),
		Point(-1, -golden, 0),
		Point(1, -golden, 0),
		Point(0, -1, golden),
		Point(0, 1, golden),
		Point(0, -1, -golden),
		Point(0, 1, -golden),
		Point(golden, 0, -1),
		Point(golden, 0, 1),
		Point(-golden, 0, -1),
		Point(-golden, 0, 1)};
	constexpr std::array<std::array<int, 3>, 20> TRIANGLES = {{
		{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
		{11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
		{3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1},
	}};

	TriangleMesh mesh;
	// A point is known by its weights at the corners of the icosahedron that have any.
	std::map<std::array<int, 6>, Index> vertices;
	const auto vertex = [&](const std::array<int, 3>& triangle, const std::array<int, 3>& weights) {
		std::array<std::pair<int, int>, 3> sorted {};
		Point point = Point::Zero();
		for (int k = 0; k < 3; ++k) {
			sorted[at(k)] = weights[at(k)] > 0 ? std::make_pair(triangle[at(k)], weights[at(k)]) :
												 std::make_pair(-1, 0);
		}
		std::sort(sorted.begin(), sorted.end());
		std::array<int, 6> key {};
		for (std::size_t k = 0; k < 3; ++k) {
			key[2 * k] = sorted[k].first;
			key[2 * k + 1] = sorted[k].second;
			if (sorted[k].first >= 0)
				point += sorted[k].second * corners[at(sorted[k].first)];
		}
		const auto [found, is_new] = vertices.emplace(key, mesh.vertex_count());
		if (is_new)
			mesh.positions.push_back(point.normalized());
		return found->second;
	};
	for (const std::array<int, 3>& triangle : TRIANGLES) {
		const auto node = [&](int i, int j) { return vertex(triangle, {frequency - i - j, i, j}); };
		for (int i = 0; i < frequency; ++i) {
			for (int j = 0; i + j < frequency; ++j) {
				mesh.faces.push_back({node(i, j), node(i + 1, j), node(i, j + 1)});
				if (i + j + 1 < frequency)
					mesh.faces.push_back({node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
			}
		}
	}
	return mesh;
}

TriangleMesh make_torus(Index faces)
{
	constexpr double RADIUS = 1.0;
	constexpr double TUBE_RADIUS = 0.4;
	const int columns = at_least(3, std::sqrt(faces / 2.0 * TUBE_RADIUS / RADIUS));
	const int rows = at_least(3, faces / 2.0 / columns);
	TriangleMesh mesh;
	for (int i = 0; i < rows; ++i) {
		for (int j = 0; j < columns; ++j) {
			const double around = 2 * PI * i / rows;
			const double tube = 2 * PI * j / columns;
			const double radius = RADIUS + TUBE_RADIUS * std::cos(tube);
			mesh.positions.emplace_back(
				radius * std::cos(around), radius * std::sin(around), TUBE_RADIUS * std::sin(tube));
		}
	}
	mesh.faces = torus_faces(rows, columns, false);
	// Rows run around the axis and columns up the outside: seen from outside that is clockwise.
	for (Face& face : mesh.faces)
		std::swap(face[1], face[2]);
	return mesh;
}

TriangleMesh make_part(Index faces)
{
	const double edge = std::sqrt(PART_AREA / (faces / 2.0));
	// The corners of the square are at odd eighths of a turn, so that they are vertices.
	const int columns = 8 * at_least(2, PART_OUTLINE / edge / 8);
	TriangleMesh mesh;
	int rows = 0;
	for (std::size_t piece = 0; piece < PART_PROFILE.size(); ++piece) {
		const int steps = at_least(1, piece_length(piece) / edge);
		for (int i = 0; i < steps; ++i) {
			const Station station = between(piece, static_cast<double>(i) / steps);
			for (int j = 0; j < columns; ++j)
				mesh.positions.push_back(outline_point(station, static_cast<double>(j) / columns));
		}
		rows += steps;
	}
	mesh.faces = torus_faces(rows, columns, true);
	return mesh;
}

TriangleMesh make_height_field(Index faces)
{
	const double edge = std::sqrt(FIELD_SHARE * FIELD_WIDTH * FIELD_DEPTH / (faces / 2.0));
	const int columns = at_least(4, FIELD_WIDTH / edge);
	const int rows = at_least(4, FIELD_DEPTH / edge);
	TriangleMesh grid;
	std::vector<bool> inside;
	for (int i = 0; i <= rows; ++i) {
		for (int j = 0; j <= columns; ++j) {
			constexpr double JITTER = 0.4;
			const double x = FIELD_WIDTH * (j + JITTER * (scatter(i, j, 1) - 0.5)) / columns;
			const double y = FIELD_DEPTH * (i + JITTER * (scatter(i, j, 2) - 0.5)) / rows;
			grid.positions.emplace_back(x, y, field_height(x, y));
			inside.push_back(is_in_field(x, y));
		}
	}
	for (int i = 0; i < rows; ++i) {
		for (int j = 0; j < columns; ++j) {
			const Index corner = i * (columns + 1) + j;
			add_square(
				{corner, corner + 1, corner + columns + 2, corner + columns + 1},
				scatter(i, j, 3) < 0.5,
				grid.faces);
		}
	}

	// What the scanner did not see is left out, vertices and all.
	TriangleMesh mesh;
	std::vector<Index> renumbered(grid.positions.size(), -1);
	for (const Face& face : grid.faces) {
		if (!std::all_of(face.begin(), face.end(), [&](Index v) { return inside[at(v)]; }))
			continue;
		Face kept {};
		for (std::size_t k = 0; k < 3; ++k) {
			Index& number = renumbered[at(face[k])];
			if (number < 0) {
				number = mesh.vertex_count();
				mesh.positions.push_back(grid.positions[at(face[k])]);
			}
			kept[k] = number;
		}
		mesh.faces.push_back(kept);
	}
	return mesh;
}

TriangleMesh make_scan_lines(Index faces)
{
	const int lines = at_least(2, std::sqrt(faces / 2.0 / SAMPLES_PER_LINE));
	const int steps = at_least(8, faces / 2.0 / lines);
	TriangleMesh mesh;
	for (int i = 0; i <= lines; ++i) {
		for (int j = 0; j <= steps; ++j) {
			const double x = SHEET_SIDE * j / steps;
			const double y = SHEET_SIDE * i / lines;
			mesh.positions.emplace_back(x, y, sheet_height(x, y));
		}
	}
	for (int i = 0; i < lines; ++i) {
		for (int j = 0; j < steps; ++j) {
			const Index corner = i * (steps + 1) + j;
			add_square(
				{corner, corner + 1, corner + steps + 2, corner + steps + 1},
				(i + j) % 2 == 0,
				mesh.faces);
		}
	}
	return mesh;
}

} // namespace orthopoly
