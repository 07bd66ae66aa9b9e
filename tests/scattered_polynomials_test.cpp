// SPDX-License-Identifier: GPL-3.0-or-later
#include "scattered_polynomials.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <random>
#include <tuple>
#include <vector>

using namespace orthopoly;

namespace {

using Cubic = ScatteredFit<3, 3>;
using Quadratic = ScatteredFit<2, 3>;
using Value = std::array<double, 3>;

struct Node {
	double x;
	double y;
	double weight = 1;
	Value value = {};
};
using Nodes = std::vector<Node>;

double draw(std::mt19937& generator)
{
	return static_cast<double>(generator()) * 0x1p-31 - 1;
}

// Nodes anywhere in the square [-1, 1]^2, with weights from 0.1 to 2.1 and values.
Nodes random_nodes(int count, std::uint32_t seed)
{
	std::mt19937 generator(seed);
	Nodes nodes;
	for (int i = 0; i < count; ++i) {
		Node node = {draw(generator), draw(generator)};
		node.weight = 1.1 + draw(generator);
		for (double& value : node.value)
			value = draw(generator);
		nodes.push_back(node);
	}
	return nodes;
}

template<class Fit>
typename Fit::Moments moments_of(const Nodes& nodes)
{
	typename Fit::Moments moments;
	for (const Node& node : nodes)
		moments.add(node.x, node.y, node.value, node.weight);
	return moments;
}

/// A fit of at most some degree.
template<class Fit>
class FitOfDegree {
public:
	static constexpr std::size_t TERMS = Fit::TERMS;

	FitOfDegree(const Nodes& nodes, std::size_t degree) :
			fit_(moments_of<Fit>(nodes)), terms_(fit_.terms(degree))
	{
	}

	std::size_t terms() const { return terms_; }
	double residual() const { return fit_.residual(terms_); }
	double energy(std::size_t term) const { return fit_.energy(term); }
	Value coefficients(std::size_t term) const
	{
		return {fit_.coefficient(term, 0), fit_.coefficient(term, 1), fit_.coefficient(term, 2)};
	}
	typename Fit::Coefficients polynomial(std::uint32_t kept) const
	{
		return fit_.polynomial(kept, terms_);
	}
	typename Fit::Terms orthonormal(const typename Fit::Terms& values) const
	{
		return fit_.orthonormal(values);
	}

private:
	Fit fit_;
	std::size_t terms_;
};

template<class Fit>
FitOfDegree<Fit> fit_of(const Nodes& nodes, std::size_t degree)
{
	return {nodes, degree};
}

constexpr std::size_t degree_of(std::size_t terms)
{
	return terms == 10 ? 3 : 2;
}

// The polynomial's value in one component.
template<class Coefficients>
double evaluate(const Coefficients& polynomial, const Node& at, std::size_t component = 0)
{
	constexpr std::size_t terms = std::tuple_size<Coefficients>::value;
	const auto values = monomials<degree_of(terms)>(at.x, at.y);
	double sum = 0;
	for (std::size_t k = 0; k < terms; ++k)
		sum += values[k] * polynomial[k][component];
	return sum;
}

// Weights as the fit takes them: scaled to a mean of one.
std::vector<double> unit_mean_weights(const Nodes& nodes)
{
	double sum = 0;
	for (const Node& node : nodes)
		sum += node.weight;
	std::vector<double> weights;
	for (const Node& node : nodes)
		weights.push_back(node.weight * static_cast<double>(nodes.size()) / sum);
	return weights;
}

template<class Fit>
double orthonormality_error(const Nodes& nodes)
{
	const FitOfDegree<Fit> fit = fit_of<Fit>(nodes, degree_of(Fit::TERMS));
	REQUIRE(fit.terms() == Fit::TERMS);
	const std::vector<double> weights = unit_mean_weights(nodes);
	using Matrix = Eigen::Matrix<double, int(Fit::TERMS), int(Fit::TERMS)>;
	Matrix products = Matrix::Zero();
	for (std::size_t i = 0; i < nodes.size(); ++i) {
		const auto values =
			fit.orthonormal(monomials<degree_of(Fit::TERMS)>(nodes[i].x, nodes[i].y));
		const Eigen::Map<const Eigen::Matrix<double, int(Fit::TERMS), 1>> row(values.data());
		products += weights[i] * row * row.transpose();
	}
	return (products - Matrix::Identity()).cwiseAbs().maxCoeff();
}

// Weighted sum of squares that a polynomial leaves over, all components, taken node by node.
template<class Coefficients>
double residual_of(const Coefficients& polynomial, const Nodes& nodes)
{
	const std::vector<double> weights = unit_mean_weights(nodes);
	double sum = 0;
	for (std::size_t i = 0; i < nodes.size(); ++i) {
		for (std::size_t c = 0; c < 3; ++c)
			sum += weights[i] * std::pow(nodes[i].value[c] - evaluate(polynomial, nodes[i], c), 2);
	}
	return sum;
}

} // namespace

TEST_CASE(
	"Polynomials are orthonormal over the nodes they were made for", "[scattered_polynomials]")
{
	for (std::uint32_t seed = 1; seed <= 20; ++seed) {
		for (const int count : {12, 40, 300}) {
			CAPTURE(seed, count);
			const Nodes nodes = random_nodes(count, seed);
			CHECK(orthonormality_error<Quadratic>(nodes) < 1e-10);
			CHECK(orthonormality_error<Cubic>(nodes) < 1e-10);
		}
	}
}

TEST_CASE("Nodes off the centre, squeezed and few keep them orthonormal", "[scattered_polynomials]")
{
	// As a structure on one side of an edge has them, or one of long thin triangles.
	Nodes aside = random_nodes(30, 3);
	for (Node& node : aside)
		node.x = 0.5 + 0.5 * node.x;
	CHECK(orthonormality_error<Cubic>(aside) < 1e-10);
	Nodes squeezed = random_nodes(30, 4);
	for (Node& node : squeezed)
		node.y *= 0.05;
	CHECK(orthonormality_error<Cubic>(squeezed) < 1e-10);
	Nodes exactly_as_many_as_terms = random_nodes(10, 5);
	CHECK(orthonormality_error<Cubic>(exactly_as_many_as_terms) < 1e-8);
}

TEST_CASE("Polynomials up to the degree come back exactly", "[scattered_polynomials]")
{
	std::mt19937 generator(11);
	for (std::size_t degree = 0; degree <= 3; ++degree) {
		Cubic::Coefficients wanted = {};
		for (std::size_t k = 0; k < term_count(degree); ++k) {
			for (double& value : wanted[k])
				value = draw(generator);
		}
		Nodes nodes = random_nodes(40, 12);
		for (Node& node : nodes) {
			for (std::size_t c = 0; c < 3; ++c)
				node.value[c] = evaluate(wanted, node, c);
		}
		const auto fit = fit_of<Cubic>(nodes, degree);
		const auto found = fit.polynomial(0x3ff);
		CAPTURE(degree);
		CHECK(fit.residual() < 1e-12);
		for (std::size_t k = 0; k < Cubic::TERMS; ++k) {
			for (std::size_t c = 0; c < 3; ++c)
				CHECK(found[k][c] == Approx(wanted[k][c]).margin(1e-10));
		}
		// One degree less does not reach it.
		if (degree > 0)
			CHECK(fit_of<Cubic>(nodes, degree - 1).residual() > 0.1);
	}
}

TEST_CASE("The fit is the weighted least-squares one", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(35, 21);
	for (std::size_t degree = 0; degree <= 3; ++degree) {
		const int terms = static_cast<int>(term_count(degree));
		Eigen::MatrixXd rows(35, terms);
		Eigen::MatrixXd values(35, 3);
		for (int i = 0; i < 35; ++i) {
			const Node& node = nodes[std::size_t(i)];
			const auto at_node = monomials<3>(node.x, node.y);
			const double root = std::sqrt(node.weight);
			for (int k = 0; k < terms; ++k)
				rows(i, k) = root * at_node[std::size_t(k)];
			for (int c = 0; c < 3; ++c)
				values(i, c) = root * node.value[std::size_t(c)];
		}
		const Eigen::MatrixXd expected = rows.colPivHouseholderQr().solve(values);
		const auto found = fit_of<Cubic>(nodes, degree).polynomial(0x3ff);
		for (int k = 0; k < terms; ++k) {
			for (int c = 0; c < 3; ++c)
				CHECK(found[std::size_t(k)][std::size_t(c)] == Approx(expected(k, c)).margin(1e-9));
		}
	}
}

TEST_CASE("Coefficients do not change when others are dropped", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(40, 31);
	const auto whole = fit_of<Cubic>(nodes, 3);
	// Of a lower degree, they are the first ones, bit for bit.
	for (std::size_t degree = 0; degree < 3; ++degree) {
		const auto lower = fit_of<Cubic>(nodes, degree);
		REQUIRE(lower.terms() == term_count(degree));
		for (std::size_t k = 0; k < lower.terms(); ++k)
			CHECK(lower.coefficients(k) == whole.coefficients(k));
	}
	// Of what a choice of them leaves over, all that were dropped are found again, and no more.
	for (const std::uint32_t kept : {0x001U, 0x007U, 0x015U, 0x209U, 0x3feU, 0x000U}) {
		CAPTURE(kept);
		const auto polynomial = whole.polynomial(kept);
		Nodes rest = nodes;
		for (Node& node : rest) {
			for (std::size_t c = 0; c < 3; ++c)
				node.value[c] -= evaluate(polynomial, node, c);
		}
		const auto again = fit_of<Cubic>(rest, 3);
		for (std::size_t k = 0; k < Cubic::TERMS; ++k) {
			for (std::size_t c = 0; c < 3; ++c) {
				const double expected = (kept >> k & 1U) != 0 ? 0 : whole.coefficients(k)[c];
				CHECK(again.coefficients(k)[c] == Approx(expected).margin(1e-10));
			}
		}
	}
}

TEST_CASE("Energies and residual add up to what is there", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(40, 41);
	const auto fit = fit_of<Cubic>(nodes, 3);
	double all = fit.residual();
	for (std::size_t k = 0; k < fit.terms(); ++k)
		all += fit.energy(k);
	CHECK(all == Approx(residual_of(Cubic::Coefficients {}, nodes)));
	for (const std::uint32_t kept : {0x3ffU, 0x001U, 0x00bU, 0x1c4U}) {
		double expected = fit.residual();
		for (std::size_t k = 0; k < fit.terms(); ++k)
			expected += (kept >> k & 1U) != 0 ? 0 : fit.energy(k);
		CHECK(residual_of(fit.polynomial(kept), nodes) == Approx(expected));
	}
}

TEST_CASE("Nodes that do not fix a degree lower it", "[scattered_polynomials]")
{
	struct Case {
		const char* name;
		double (*x)(double);
		double (*y)(double);
		std::size_t terms;
	};
	// t runs over [-1, 1].
	const std::vector<Case> cases = {
		{"one place", [](double) { return 0.3; }, [](double) { return -0.2; }, 1},
		{"the centre", [](double) { return 0.0; }, [](double) { return 0.0; }, 1},
		{"along x", [](double t) { return t; }, [](double) { return 0.0; }, 1},
		{"along y", [](double) { return 0.0; }, [](double t) { return t; }, 1},
		{"a slanting line", [](double t) { return 0.2 + t; }, [](double t) { return 3 * t; }, 1},
		{"a circle",
		 [](double t) { return std::cos(3 * t); },
		 [](double t) { return std::sin(3 * t); },
		 3},
		{"a parabola", [](double t) { return t; }, [](double t) { return t * t; }, 3},
		{"a hyperbola",
		 [](double t) { return t + 1.5; },
		 [](double t) { return 1 / (t + 1.5); },
		 3},
		{"two lines", [](double t) { return t; }, [](double t) { return std::abs(t); }, 3},
		{"a cubic", [](double t) { return t; }, [](double t) { return t * t * t; }, 6},
	};
	for (const Case& a_case : cases) {
		CAPTURE(a_case.name);
		Nodes nodes = random_nodes(40, 51);
		for (std::size_t i = 0; i < nodes.size(); ++i) {
			const double t = 2.0 * double(i) / double(nodes.size() - 1) - 1;
			nodes[i].x = a_case.x(t);
			nodes[i].y = a_case.y(t);
		}
		const auto fit = fit_of<Cubic>(nodes, 3);
		CHECK(fit.terms() == a_case.terms);
		// What is left is an honest fit: no worse than the mean, and its residual is what it says.
		const auto polynomial = fit.polynomial(0x3ff);
		CHECK(residual_of(polynomial, nodes) == Approx(fit.residual()));
		CHECK(fit.residual() <= fit_of<Cubic>(nodes, 0).residual());
		for (std::size_t k = fit.terms(); k < Cubic::TERMS; ++k)
			CHECK(polynomial[k] == Value {0, 0, 0});
	}
}

TEST_CASE("Fewer nodes than terms lower the degree", "[scattered_polynomials]")
{
	for (int count = 1; count <= 10; ++count) {
		CAPTURE(count);
		const Nodes nodes = random_nodes(count, 61);
		const auto fit = fit_of<Cubic>(nodes, 3);
		CHECK(fit.terms() == std::size_t(count < 3 ? 1 : count < 6 ? 3 : count < 10 ? 6 : 10));
		CHECK(residual_of(fit.polynomial(0x3ff), nodes) == Approx(fit.residual()).margin(1e-12));
	}
}

TEST_CASE("The constant is the weighted mean", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(15, 71);
	const std::vector<double> weights = unit_mean_weights(nodes);
	double mean = 0;
	for (std::size_t i = 0; i < nodes.size(); ++i)
		mean += weights[i] * nodes[i].value[1] / 15;
	CHECK(fit_of<Quadratic>(nodes, 2).polynomial(1)[0][1] == Approx(mean));
}

TEST_CASE("Weights count as that many nodes, their size does not matter", "[scattered_polynomials]")
{
	Nodes nodes = random_nodes(20, 81);
	for (Node& node : nodes)
		node.weight = 1;
	Nodes twice = nodes;
	twice.push_back(nodes[7]);
	Nodes weighted = nodes;
	weighted[7].weight = 2;
	const auto expected = fit_of<Quadratic>(twice, 2).polynomial(0x3f);
	const auto found = fit_of<Quadratic>(weighted, 2).polynomial(0x3f);
	const auto without = fit_of<Quadratic>(nodes, 2).polynomial(0x3f);
	double largest = 0;
	for (std::size_t k = 0; k < Quadratic::TERMS; ++k) {
		for (std::size_t c = 0; c < 3; ++c) {
			CHECK(found[k][c] == Approx(expected[k][c]).margin(1e-12));
			largest = std::max(largest, std::abs(without[k][c] - expected[k][c]));
		}
	}
	CHECK(largest > 1e-3);

	Nodes heavy = random_nodes(20, 82);
	const auto light = fit_of<Quadratic>(heavy, 2);
	for (Node& node : heavy)
		node.weight *= 1024;
	const auto fit = fit_of<Quadratic>(heavy, 2);
	for (std::size_t k = 0; k < Quadratic::TERMS; ++k)
		CHECK(fit.coefficients(k) == light.coefficients(k));
	CHECK(fit.residual() == light.residual());

	// A node without weight is as good as none.
	weighted[7].weight = 0;
	nodes.erase(nodes.begin() + 7);
	const auto none = fit_of<Quadratic>(weighted, 2).polynomial(0x3f);
	const auto gone = fit_of<Quadratic>(nodes, 2).polynomial(0x3f);
	for (std::size_t k = 0; k < Quadratic::TERMS; ++k)
		CHECK(none[k][0] == Approx(gone[k][0]).margin(1e-12));
}

TEST_CASE("A unit of length changes no value of the fit", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(30, 91);
	const auto polynomial = fit_of<Cubic>(nodes, 3).polynomial(0x2d7);
	for (const double unit : {0x1p-12, 1e-3, 0x1p8}) {
		CAPTURE(unit);
		Nodes scaled = nodes;
		for (Node& node : scaled) {
			node.x *= unit;
			node.y *= unit;
		}
		const auto fit = fit_of<Cubic>(scaled, 3);
		REQUIRE(fit.terms() == 10);
		for (std::size_t i = 0; i < nodes.size(); ++i)
			CHECK(
				evaluate(fit.polynomial(0x2d7), scaled[i]) ==
				Approx(evaluate(polynomial, nodes[i])).margin(1e-9));
	}
}

TEST_CASE("Moments may be added to between fits", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(30, 101);
	Quadratic::Moments moments;
	const auto check = [&](const Nodes& so_far) {
		CHECK(
			Quadratic(moments).polynomial(0x3f, Quadratic::TERMS) ==
			fit_of<Quadratic>(so_far, 2).polynomial(0x3f));
	};
	for (std::size_t i = 0; i < nodes.size(); ++i) {
		moments.add(nodes[i].x, nodes[i].y, nodes[i].value, nodes[i].weight);
		if (i == 14)
			check(Nodes(nodes.begin(), nodes.begin() + 15));
	}
	check(nodes);
}

TEST_CASE(
	"Structures fitted side by side come out as alone, bit for bit", "[scattered_polynomials]")
{
	// One of them has too few nodes, one none.
	const std::array<int, LANES> counts = {40, 7, 0, 23};
	std::array<ScatteredMoments<3, 3>, LANES> moments;
	for (std::size_t lane = 0; lane < LANES; ++lane)
		moments[lane] = moments_of<Cubic>(random_nodes(counts[lane], 91));
	const ScatteredFit<3, 3, Lanes> together(side_by_side<Lanes>(moments));
	for (std::size_t lane = 0; lane < LANES; ++lane) {
		CAPTURE(lane);
		const Cubic alone(moments[lane]);
		const std::size_t terms = alone.terms(3);
		REQUIRE(together.terms(3, lane) == terms);
		REQUIRE((terms > 0) == (counts[lane] > 0));
		CHECK(together.residual(terms, lane) == alone.residual(terms));
		const auto slopes = together.orthonormal({0, 1, 0});
		for (std::size_t k = 0; k < terms; ++k) {
			CHECK(together.energy(k, lane) == alone.energy(k));
			CHECK(slopes[k][lane] == alone.orthonormal({0, 1, 0})[k]);
		}
		const std::uint32_t kept = 0x1c7U & ((1U << terms) - 1);
		CHECK(together.polynomial(kept, terms, lane) == alone.polynomial(kept, terms));
	}
}

TEST_CASE("Nodes taken in four at a time give the same sums", "[scattered_polynomials]")
{
	const Nodes nodes = random_nodes(22, 95);
	ScatteredMoments<2, 3, Lanes> lanes;
	for (std::size_t k = 0; k < nodes.size(); k += LANES) {
		// The last group is filled up with a node of no weight.
		const auto gather = [&](auto value_of) {
			std::array<double, LANES> values = {};
			for (std::size_t lane = 0; lane < LANES && k + lane < nodes.size(); ++lane)
				values[lane] = value_of(nodes[k + lane]);
			return Lanes(values);
		};
		lanes.add(
			gather([](const Node& n) { return n.x; }),
			gather([](const Node& n) { return n.y; }),
			{gather([](const Node& n) { return n.value[0]; }),
			 gather([](const Node& n) { return n.value[1]; }),
			 gather([](const Node& n) { return n.value[2]; })},
			gather([](const Node& n) { return n.weight; }));
	}
	ScatteredMoments<2, 3> found;
	add_up(lanes, 22, found);
	const ScatteredMoments<2, 3> expected = moments_of<Quadratic>(nodes);
	CHECK(found.count == expected.count);
	CHECK(found.energy == Approx(expected.energy));
	for (std::size_t k = 0; k < expected.powers.size(); ++k)
		CHECK(found.powers[k] == Approx(expected.powers[k]).margin(1e-12));
	for (std::size_t k = 0; k < expected.values.size(); ++k)
		CHECK(found.values[k][1] == Approx(expected.values[k][1]).margin(1e-12));
}
