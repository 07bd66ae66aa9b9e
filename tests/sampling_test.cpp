// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling.h"

#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <iterator>
#include <numeric>
#include <random>
#include <vector>

using namespace orthopoly;

namespace {

// Areas of triangles, as it were: all different, over a range of ten to one.
std::vector<double> areas(int count, std::uint32_t seed = 1)
{
	std::mt19937 generator(seed);
	std::vector<double> values;
	for (int i = 0; i < count; ++i)
		values.push_back(0.1 + 0.9 * static_cast<double>(generator()) * 0x1p-32);
	return values;
}

std::vector<double> sampled_values(const std::vector<double>& values, Index wanted)
{
	std::vector<double> chosen;
	for (const Index i : sample_by_value(values, wanted))
		chosen.push_back(values[static_cast<std::size_t>(i)]);
	std::sort(chosen.begin(), chosen.end());
	return chosen;
}

} // namespace

TEST_CASE("All are taken where there are not many more than wanted", "[sampling]")
{
	for (const int count : {0, 1, 50, 100, 199}) {
		const std::vector<Index> sample = sample_by_value(areas(count), 100);
		REQUIRE(sample.size() == static_cast<std::size_t>(count));
		for (std::size_t i = 0; i < sample.size(); ++i)
			CHECK(sample[i] == static_cast<Index>(i));
	}
	CHECK(sample_by_value(areas(20), 0).empty());
}

TEST_CASE("About as many as wanted are taken, each once, in order", "[sampling]")
{
	for (const Index wanted : {500, 2000, 4000}) {
		const std::vector<Index> sample = sample_by_value(areas(20000), wanted);
		CHECK(sample.size() > 0.75 * wanted);
		CHECK(sample.size() < 1.25 * wanted);
		CHECK(
			std::adjacent_find(sample.begin(), sample.end(), std::greater_equal<Index>()) ==
			sample.end());
		CHECK(sample.front() >= 0);
		CHECK(sample.back() < 20000);
	}
}

TEST_CASE("The sample is a fair one", "[sampling]")
{
	// A sample of large or of small triangles would give a quantile of large or small ones.
	std::vector<double> values = areas(20000, 3);
	std::vector<double> chosen = sampled_values(values, 2500);
	for (const double share : {0.1, 0.35, 0.5, 0.9})
		CHECK(quantile(chosen, share) == Approx(quantile(values, share)).margin(0.05));
	// Nor does it come from one part of the mesh.
	const std::vector<Index> sample = sample_by_value(areas(20000), 2500);
	const auto first_half =
		std::count_if(sample.begin(), sample.end(), [](Index i) { return i < 10000; });
	CHECK(std::abs(double(first_half) / double(sample.size()) - 0.5) < 0.05);
}

TEST_CASE("The same items are taken whatever their order", "[sampling]")
{
	std::vector<double> values = areas(20000, 2);
	const std::vector<double> expected = sampled_values(values, 2500);
	std::mt19937 generator(9);
	for (int i = 0; i < 5; ++i) {
		std::shuffle(values.begin(), values.end(), generator);
		CHECK(sampled_values(values, 2500) == expected);
	}
	std::reverse(values.begin(), values.end());
	CHECK(sampled_values(values, 2500) == expected);
}

TEST_CASE("The unit of the values changes no item", "[sampling]")
{
	const std::vector<double> values = areas(20000, 4);
	const std::vector<Index> expected = sample_by_value(values, 2500);
	for (const double unit : {0x1p-20, 0x1p+20, 1e-6, 1e6}) {
		CAPTURE(unit);
		std::vector<double> scaled = values;
		for (double& value : scaled)
			value *= unit;
		const std::vector<Index> sample = sample_by_value(scaled, 2500);
		std::vector<Index> differing;
		std::set_symmetric_difference(
			sample.begin(),
			sample.end(),
			expected.begin(),
			expected.end(),
			std::back_inserter(differing));
		// A digit turns over by rounding once in a thousand million values or so.
		CHECK(differing.empty());
	}
}

TEST_CASE("Of values many of which are alike as many are taken", "[sampling]")
{
	// The faces of a cube's grid, with noise in none of them, in a tenth and in half of them.
	for (const int one_in : {0, 10, 2}) {
		CAPTURE(one_in);
		std::vector<double> values(20000, 0.37);
		const std::vector<double> others = areas(20000);
		for (std::size_t i = 0; one_in > 0 && i < values.size(); i += std::size_t(one_in))
			values[i] = others[i];
		const std::vector<Index> sample = sample_by_value(values, 2500);
		CHECK(sample.size() > 2000);
		CHECK(sample.size() < 3000);
		const auto alike = std::count_if(sample.begin(), sample.end(), [&](Index i) {
			return values[static_cast<std::size_t>(i)] == 0.37;
		});
		CHECK(
			double(alike) / double(sample.size()) ==
			Approx(one_in > 0 ? 1 - 1.0 / one_in : 1.0).margin(0.11));
	}
}

TEST_CASE("Values that are not positive are left out of the sample", "[sampling]")
{
	// As those of vertices without a face: they would be most of it.
	std::vector<double> values = areas(20000);
	const std::vector<double> expected = sampled_values(values, 2500);
	values.resize(50000, 0.0);
	std::shuffle(values.begin(), values.end(), std::mt19937(5));
	CHECK(sampled_values(values, 2500) == expected);
	CHECK(sample_by_value({0, 2, -1, 3}, 100) == std::vector<Index> {1, 3});
	CHECK(sample_by_value(std::vector<double>(20000, 0.0), 2500).empty());
}

TEST_CASE("About one face in so many is chosen, everywhere alike", "[sampling]")
{
	const StepFixture f(make_torus(20000));
	const std::vector<double> values = areas(f.mesh.face_count());
	for (const int one_in : {1, 2, 3, 4}) {
		CAPTURE(one_in);
		const std::vector<std::uint8_t> flags = choose_evenly(f.workspace, values, one_in);
		REQUIRE(flags.size() == values.size());
		CHECK(
			static_cast<double>(std::count(flags.begin(), flags.end(), 1)) ==
			Approx(static_cast<double>(flags.size()) / one_in).epsilon(0.05));
		// Faces chosen within two rings, some forty faces, over all: were each chosen for itself,
		// their number would have the variance p (1 - p) for a face.
		RingCollector rings = f.workspace.ring_collector();
		double sum = 0;
		double squares = 0;
		double faces = 0;
		for (Index i = 0; i < f.mesh.face_count(); ++i) {
			rings.collect(i, 2);
			double chosen = 0;
			for (const Index j : rings.faces())
				chosen += flags[static_cast<std::size_t>(j)];
			sum += chosen;
			squares += chosen * chosen;
			faces += static_cast<double>(rings.faces().size());
		}
		const double count = f.mesh.face_count();
		const double variance = squares / count - sum / count * sum / count;
		const double share = 1.0 / one_in;
		CHECK(variance <= 0.5 * share * (1 - share) * faces / count);
	}
}

TEST_CASE("The same faces are chosen whatever their order and unit", "[sampling]")
{
	const TriangleMesh mesh = make_torus(5000);
	const std::vector<double> values = areas(mesh.face_count());
	TriangleMesh reversed = mesh;
	std::reverse(reversed.faces.begin(), reversed.faces.end());
	std::vector<double> reversed_values(values.rbegin(), values.rend());
	for (double& value : reversed_values)
		value *= 0x1p-20;
	const StepFixture f(mesh);
	const StepFixture g(reversed, 3);
	std::vector<std::uint8_t> flags = choose_evenly(g.workspace, reversed_values, 3);
	std::reverse(flags.begin(), flags.end());
	CHECK(flags == choose_evenly(f.workspace, values, 3));
}

TEST_CASE("All faces are chosen where their values are all alike", "[sampling]")
{
	const StepFixture f(make_torus(2000));
	const auto count = static_cast<std::size_t>(f.mesh.face_count());
	const std::vector<std::uint8_t> all(count, 1);
	CHECK(choose_evenly(f.workspace, std::vector<double>(count, 2.5), 4) == all);
	CHECK(choose_evenly(f.workspace, std::vector<double>(count, 0.0), 4) == all);
}

TEST_CASE("A quantile has that share of the values below it", "[sampling]")
{
	std::vector<double> values(101);
	std::iota(values.begin(), values.end(), 0.0);
	std::mt19937 generator(1);
	for (const double share : {0.0, 0.3, 0.35, 0.5, 0.99, 1.0}) {
		std::shuffle(values.begin(), values.end(), generator);
		CHECK(quantile(values, share) == Approx(100 * share).margin(1));
	}
	std::vector<double> none;
	CHECK(quantile(none, 0.5) == 0);
	std::vector<double> one = {3.5};
	CHECK(quantile(one, 0.3) == 3.5);
	// Outliers above do not move a low one.
	std::fill(values.begin() + 50, values.end(), 0.0);
	std::iota(values.begin(), values.end(), 0.0);
	const double before = quantile(values, 0.3);
	std::sort(values.begin(), values.end());
	std::for_each(values.begin() + 60, values.end(), [](double& v) { v *= 1e9; });
	CHECK(quantile(values, 0.3) == before);
}

TEST_CASE("A part of a sample has those of the same values in any order", "[sampling]")
{
	std::vector<double> values;
	const std::vector<double> all = areas(200000);
	for (const Index i : sample_by_value(all, 20000))
		values.push_back(all[static_cast<std::size_t>(i)]);
	const auto chosen = [](const std::vector<double>& given) {
		std::vector<double> result;
		for (const std::size_t k : subsample_by_value(given, 500))
			result.push_back(given[k]);
		std::sort(result.begin(), result.end());
		return result;
	};
	const std::vector<double> expected = chosen(values);
	CHECK(expected.size() > 350);
	CHECK(expected.size() < 650);
	std::reverse(values.begin(), values.end());
	CHECK(chosen(values) == expected);
	// All alike: by number.
	const std::vector<std::size_t> alike = subsample_by_value(std::vector<double>(20000, 2.0), 500);
	CHECK(alike.size() > 350);
	CHECK(alike.size() < 650);
	CHECK(subsample_by_value(areas(700), 500).size() == 700);
	CHECK(subsample_by_value({}, 500).empty());
}

TEST_CASE("Signs are thrown by values, by numbers where these are alike", "[sampling]")
{
	std::mt19937 generator(1);
	std::uniform_real_distribution<double> uniform(0.5, 1.5);
	std::vector<double> values(10000);
	for (double& value : values)
		value = uniform(generator);
	const auto sum = [](const std::vector<double>& signs) {
		return std::accumulate(signs.begin(), signs.end(), 0.0);
	};
	const std::vector<double> signs = signs_by_value(values);
	CHECK(std::abs(sum(signs)) < 500);
	CHECK(std::all_of(signs.begin(), signs.end(), [](double sign) { return std::abs(sign) == 1; }));
	// Neighbours in value have nothing in common, nor have those in number.
	std::vector<double> sorted = values;
	std::sort(sorted.begin(), sorted.end());
	for (const std::vector<double>& thrown : {signs, signs_by_value(sorted)}) {
		double products = 0;
		for (std::size_t k = 1; k < thrown.size(); ++k)
			products += thrown[k] * thrown[k - 1];
		CHECK(std::abs(products) < 500);
	}
	std::vector<double> turned(values.rbegin(), values.rend());
	for (double& value : turned)
		value *= 1e3 * (1 + 1e-15);
	const std::vector<double> of_turned = signs_by_value(turned);
	CHECK(std::equal(signs.begin(), signs.end(), of_turned.rbegin()));
	CHECK(std::abs(sum(signs_by_value(std::vector<double>(10000, 0.7)))) < 500);
	CHECK(signs_by_value({}).empty());
	// What has no value takes no part.
	std::vector<double> with_nothing = values;
	with_nothing.insert(with_nothing.begin() + 10, 20000, 0);
	const std::vector<double> of_some = signs_by_value(with_nothing);
	CHECK(std::equal(signs.begin() + 10, signs.end(), of_some.begin() + 20010));
	CHECK(of_some[10] == 0);
}
