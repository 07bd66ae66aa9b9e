// SPDX-License-Identifier: GPL-3.0-or-later
#include "execution.h"

#include "errors.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <thread>
#include <unsupported/Eigen/CXX11/ThreadPool>
#include <vector>

namespace orthopoly {

namespace {

// Below this many parts a loop is over before a sleeping thread has woken up.
constexpr Index FEWEST_PARTS_FOR_THREADS = 4;

// A caller hears of the work twenty times a second, and a cancel is obeyed as fast.
constexpr std::chrono::milliseconds REPORT_INTERVAL(50);

// Terms are added up in blocks of this size, so that the order does not depend on the threads.
constexpr Index SUM_BLOCK = 4096;

} // namespace

/// The threads besides the calling one.
class Execution::Workers {
public:
	explicit Workers(int count) : pool_(count) {}

	Eigen::ThreadPool& pool() { return pool_; }

private:
	Eigen::ThreadPool pool_;
};

Execution::Execution(int threads, Progress& progress) : progress_(progress), threads_(threads)
{
	if (threads < 0)
		throw InvalidParameter(
			"threads is " + std::to_string(threads) +
			"; give 1 or more, or 0 for one per processor");
	if (threads_ == 0)
		threads_ = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
	if (threads_ > 1)
		workers_ = std::make_unique<Workers>(threads_ - 1);
}

Execution::~Execution() = default;

void Execution::begin_phase(double begin, double end, std::string words)
{
	phase_begin_ = begin;
	phase_end_ = end;
	words_ = std::move(words);
	last_report_ = {};
	begin_part(0, 1);
	poll(0);
}

void Execution::begin_part(int part, int parts, int count)
{
	part_begin_ = static_cast<double>(part) / parts;
	part_length_ = static_cast<double>(count) / parts;
	poll(0);
}

void Execution::poll(double fraction_of_part)
{
	const auto now = std::chrono::steady_clock::now();
	if (now - last_report_ >= REPORT_INTERVAL) {
		last_report_ = now;
		const double fraction_of_phase = part_begin_ + fraction_of_part * part_length_;
		progress_.report(phase_begin_ + fraction_of_phase * (phase_end_ - phase_begin_), words_);
	}
	if (progress_.cancelled())
		throw Cancelled();
}

void Execution::parallel_for(Index count, Index grain, const Body& body)
{
	if (count <= 0)
		return;
	const Index parts = (count - 1) / grain + 1;
	std::atomic<Index> next(0);
	std::atomic<bool> halt(false);

	const auto run_part = [&](Index part, int worker) {
		const Index begin = part * grain;
		body(begin, std::min<Index>(count, begin + grain), worker);
	};

	const int helpers =
		parts < FEWEST_PARTS_FOR_THREADS ? 0 : std::min<int>(threads_ - 1, parts - 1);
	std::vector<std::exception_ptr> errors(static_cast<std::size_t>(helpers) + 1);
	const auto run_guarded = [&](int worker, bool calling_thread) {
		try {
			for (Index part = next.fetch_add(1); part < parts && !halt.load();
				 part = next.fetch_add(1)) {
				run_part(part, worker);
				if (calling_thread)
					poll(static_cast<double>(part) / static_cast<double>(parts));
			}
		}
		catch (...) {
			errors[static_cast<std::size_t>(worker)] = std::current_exception();
			halt.store(true);
		}
	};

	if (helpers == 0) {
		run_guarded(0, true);
	}
	else {
		Eigen::Barrier done(static_cast<unsigned>(helpers));
		for (int helper = 1; helper <= helpers; ++helper) {
			workers_->pool().Schedule([&, helper]() {
				run_guarded(helper, false);
				done.Notify();
			});
		}
		run_guarded(0, true);
		done.Wait();
	}
	for (const std::exception_ptr& error : errors) {
		if (error)
			std::rethrow_exception(error);
	}
}

double Execution::sum(Index count, const std::function<double(Index)>& term)
{
	if (count <= 0)
		return 0;
	const Index blocks = (count - 1) / SUM_BLOCK + 1;
	std::vector<double> sums(static_cast<std::size_t>(blocks), 0.0);
	parallel_for(blocks, 1, [&](Index begin, Index end, int) {
		for (Index block = begin; block < end; ++block) {
			const Index last = std::min<Index>(count, (block + 1) * SUM_BLOCK);
			double& sum = sums[static_cast<std::size_t>(block)];
			for (Index i = block * SUM_BLOCK; i < last; ++i)
				sum += term(i);
		}
	});
	return std::accumulate(sums.begin(), sums.end(), 0.0);
}

} // namespace orthopoly
