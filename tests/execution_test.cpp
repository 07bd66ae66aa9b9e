// SPDX-License-Identifier: GPL-3.0-or-later
#include "execution.h"

#include "errors.h"

#include <atomic>
#include <catch2/catch.hpp>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

using namespace orthopoly;

TEST_CASE("a loop visits every index once on any number of threads", "[execution][parallel]")
{
	const int threads = GENERATE(1, 2, 3, 8);
	const Index count = GENERATE(0, 1, 5, 64, 1000, 10007);
	const Index grain = GENERATE(1, 7, 256);
	Progress progress;
	Execution execution(threads, progress);
	CHECK(execution.threads() == threads);
	std::vector<int> visits(static_cast<std::size_t>(count), 0);
	std::atomic<bool> worker_out_of_range(false);
	execution.parallel_for(count, grain, [&](Index begin, Index end, int worker) {
		if (worker < 0 || worker >= threads)
			worker_out_of_range = true;
		for (Index i = begin; i < end; ++i)
			++visits[static_cast<std::size_t>(i)];
	});
	CHECK_FALSE(worker_out_of_range);
	CHECK(visits == std::vector<int>(static_cast<std::size_t>(count), 1));
}

TEST_CASE("a worker runs one part at a time", "[execution][parallel]")
{
	Progress progress;
	Execution execution(4, progress);
	std::vector<std::atomic<int>> running(4);
	std::atomic<bool> overlap(false);
	execution.parallel_for(4000, 8, [&](Index, Index, int worker) {
		if (running[static_cast<std::size_t>(worker)].fetch_add(1) != 0)
			overlap = true;
		running[static_cast<std::size_t>(worker)].fetch_sub(1);
	});
	CHECK_FALSE(overlap);
}

TEST_CASE("a sum is the same bit for bit on any number of threads", "[execution][parallel]")
{
	const auto term = [](Index i) { return std::sin(i) * std::pow(10.0, i % 17 - 8); };
	std::set<double> sums;
	for (const int threads : {1, 2, 3, 8}) {
		Progress progress;
		Execution execution(threads, progress);
		sums.insert(execution.sum(100000, term));
	}
	CHECK(sums.size() == 1);
	Progress progress;
	Execution execution(2, progress);
	CHECK(execution.sum(0, term) == 0);
	CHECK(execution.sum(10000, [](Index i) { return i; }) == 10000.0 * 9999 / 2);
}

TEST_CASE(
	"the callback is called from the calling thread only, and never goes back",
	"[execution][parallel]")
{
	const std::thread::id caller = std::this_thread::get_id();
	bool other_thread = false;
	std::vector<int> percents;
	std::vector<std::string> words;
	Progress progress([&](int percent, const std::string& text) {
		other_thread |= std::this_thread::get_id() != caller;
		percents.push_back(percent);
		words.push_back(text);
		return true;
	});
	Execution execution(4, progress);
	execution.begin_phase(0.2, 0.5, "first");
	execution.parallel_for(300, 1, [](Index, Index, int) {
		std::this_thread::sleep_for(std::chrono::milliseconds(2));
	});
	execution.begin_phase(0.5, 0.9, "second");
	CHECK_FALSE(other_thread);
	REQUIRE(percents.size() >= 3);
	CHECK(percents.front() == 20);
	CHECK(percents.back() == 50);
	CHECK(std::is_sorted(percents.begin(), percents.end()));
	CHECK(words.front() == "first");
	CHECK(words.back() == "second");
	CHECK(std::any_of(percents.begin(), percents.end(), [](int p) { return p > 20 && p < 50; }));
}

TEST_CASE("a cancel stops the loop and all workers", "[execution][parallel]")
{
	const int threads = GENERATE(1, 4);
	int calls = 0;
	Progress progress([&](int, const std::string&) { return ++calls < 3; });
	Execution execution(threads, progress);
	std::atomic<Index> visited(0);
	std::atomic<int> active(0);
	const auto work = [&]() {
		execution.begin_phase(0, 1, "work");
		execution.parallel_for(100000, 1, [&](Index, Index, int) {
			++active;
			++visited;
			std::this_thread::sleep_for(std::chrono::milliseconds(1));
			--active;
		});
	};
	const auto start = std::chrono::steady_clock::now();
	CHECK_THROWS_AS(work(), Cancelled);
	CHECK(active == 0);
	CHECK(visited < 5000);
	CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(2));
	// It stays cancelled, and says so before any more work.
	const Index before = visited;
	CHECK_THROWS_AS(execution.begin_phase(0, 1, "again"), Cancelled);
	CHECK(visited == before);
}

TEST_CASE("an exception of the body comes out of the loop", "[execution][parallel]")
{
	const int threads = GENERATE(1, 3);
	Progress progress;
	Execution execution(threads, progress);
	const auto run = [&]() {
		execution.parallel_for(1000, 1, [](Index begin, Index, int) {
			if (begin == 700)
				throw std::runtime_error("part 700");
		});
	};
	CHECK_THROWS_WITH(run(), "part 700");
	// The threads are there for the next loop.
	std::atomic<Index> visited(0);
	execution.parallel_for(1000, 1, [&](Index, Index, int) { ++visited; });
	CHECK(visited == 1000);
}

TEST_CASE("the number of threads", "[execution]")
{
	Progress progress;
	CHECK(Execution(0, progress).threads() >= 1);
	CHECK_THROWS_AS(Execution(-1, progress), InvalidParameter);
	CHECK_THROWS_WITH(Execution(-2, progress), Catch::Contains("-2"));
}

TEST_CASE("progress never falls and ends at its whole", "[execution]")
{
	std::vector<int> percents;
	Progress progress([&](int percent, const std::string&) {
		percents.push_back(percent);
		return true;
	});
	for (const double fraction : {0.1, 0.5, 0.3, 1.7, 0.2})
		CHECK(progress.report(fraction, ""));
	CHECK(percents == std::vector<int> {10, 50, 50, 100, 100});
	CHECK_FALSE(progress.cancelled());
}

TEST_CASE("a cancelled progress does not ask again", "[execution]")
{
	int calls = 0;
	Progress progress([&](int, const std::string&) {
		++calls;
		return false;
	});
	CHECK_FALSE(progress.report(0, ""));
	CHECK_FALSE(progress.report(0.5, ""));
	CHECK(progress.cancelled());
	CHECK(calls == 1);
	Progress silent;
	CHECK(silent.report(0.5, ""));
}
