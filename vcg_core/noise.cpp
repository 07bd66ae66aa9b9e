// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise.h"

#include "errors.h"
#include "parameters.h"
#include "seams.h"

#include <cmath>
#include <string>

namespace orthopoly {

namespace {

// The natural logarithm by nothing but the four operations, which IEEE 754 rounds the same
// everywhere; that of the C library may differ in the last bit from one system to the next.
double portable_log(double value)
{
	constexpr double LN_2 = 0.69314718055994530942;
	constexpr double SQRT_HALF = 0.70710678118654752440;
	// From (sqrt(1/2), sqrt(2)) the last term is below 2^-53 of the first.
	constexpr int LAST_TERM = 21;
	int exponent = 0;
	double mantissa = std::frexp(value, &exponent);
	if (mantissa < SQRT_HALF) {
		mantissa *= 2;
		--exponent;
	}
	// ln m = 2 artanh z = 2 (z + z^3 / 3 + z^5 / 5 + ...)
	const double z = (mantissa - 1) / (mantissa + 1);
	double sum = 0;
	for (int term = LAST_TERM; term >= 1; term -= 2)
		sum = sum * (z * z) + 1.0 / term;
	return exponent * LN_2 + 2 * z * sum;
}

// PCG32 (O'Neill 2014) and the polar method of Marsaglia (1964).
class RandomNumbers {
public:
	explicit RandomNumbers(std::uint32_t seed)
	{
		next();
		state_ += seed;
		next();
	}

	// Evenly in the open interval (0, 1), in steps of 2^-53.
	double uniform()
	{
		const std::uint64_t high = next() >> 6U;
		const std::uint64_t low = next() >> 6U;
		return (static_cast<double>((high << 26U) | low) + 0.5) * 0x1p-52;
	}

	// Standard normal.
	double gaussian()
	{
		if (has_spare_) {
			has_spare_ = false;
			return spare_;
		}
		double x = 0;
		double y = 0;
		double squared = 0;
		do {
			x = 2 * uniform() - 1;
			y = 2 * uniform() - 1;
			squared = x * x + y * y;
		} while (squared >= 1 || squared == 0);
		const double factor = std::sqrt(-2 * portable_log(squared) / squared);
		spare_ = y * factor;
		has_spare_ = true;
		return x * factor;
	}

	Point gaussian_vector()
	{
		const double x = gaussian();
		const double y = gaussian();
		const double z = gaussian();
		return {x, y, z};
	}

private:
	std::uint32_t next()
	{
		const std::uint64_t old = state_;
		state_ = old * 6364136223846793005U + 1442695040888963407U;
		const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
		const auto rotation = static_cast<std::uint32_t>(old >> 59U);
		return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
	}

	std::uint64_t state_ = 0;
	bool has_spare_ = false;
	double spare_ = 0;
};

// Unit vectors; zero where the faces around a vertex have no area or cancel out.
std::vector<Point> vertex_normals(const TriangleMesh& mesh)
{
	std::vector<Point> normals(mesh.positions.size(), Point::Zero());
	for (const Face& face : mesh.faces) {
		const Point cross = face_cross_product(mesh.positions, face);
		for (const Index vertex : face)
			normals[static_cast<std::size_t>(vertex)] += cross;
	}
	for (Point& normal : normals) {
		const double length = normal.norm();
		normal = length > 0 ? Point(normal / length) : Point(Point::Zero());
	}
	return normals;
}

} // namespace

std::vector<Point> add_noise(const TriangleMesh& given, const NoiseOptions& options)
{
	for (const Parameter<NoiseOptions>& parameter : noise_parameters())
		parameter.check(parameter.get(options));
	validate(given);
	if (given.faces.empty())
		throw InvalidMesh(
			"the mesh has " + std::to_string(given.vertex_count()) +
			" vertices and no faces, so there is no mean edge length to scale the noise by; "
			"give a triangle mesh");

	const Seams seams = find_seams(given);
	const TriangleMesh mesh = sew(given, seams);
	const double amplitude = options.sigma * mean_edge_length(mesh.positions, mesh.faces);
	std::vector<Point> normals;
	if (options.direction == NoiseDirection::Normal)
		normals = vertex_normals(mesh);

	RandomNumbers random(options.seed);
	std::vector<Point> displacements(mesh.positions.size(), Point::Zero());
	for (std::size_t i = 0; i < displacements.size(); ++i) {
		// Drawn for every vertex, moved or not, so that the others do not depend on it.
		const bool chosen = random.uniform() < options.impulsive_share;
		Point displacement;
		if (options.direction == NoiseDirection::Isotropic) {
			displacement = random.gaussian_vector();
		}
		else {
			const double length = random.gaussian();
			displacement = length * (options.direction == NoiseDirection::Normal ?
										 normals[i] :
										 Point(random.gaussian_vector().normalized()));
		}
		if (chosen && !mesh.is_fixed(static_cast<Index>(i)))
			displacements[i] = amplitude * displacement;
	}
	std::vector<Point> positions = given.positions;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const Point& displacement = displacements[at(seams.sewn(static_cast<Index>(i)))];
		if (!displacement.isZero(0))
			positions[i] += displacement;
	}
	return positions;
}

} // namespace orthopoly
