// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "progress.h"
#include "triangle_mesh.h"

#include <chrono>
#include <functional>
#include <memory>
#include <string>

namespace orthopoly {

/// Thrown inside the library when the caller asked to stop; `denoise` turns it into a status.
struct Cancelled {};

/// The threads a computation runs on, and the way it reports progress and hears of a cancel.
///
/// Loops gather: the body writes only what belongs to its own indices, so that the result is the
/// same bit for bit on any number of threads.
class Execution {
public:
	/// Part of a loop: indices [begin, end), on worker 0 to threads() - 1. A worker runs one part
	/// at a time, so scratch memory may be kept per worker.
	using Body = std::function<void(Index begin, Index end, int worker)>;

	/// @param threads  0 means one per processor. Throws InvalidParameter below 0.
	/// @param progress reported to from the calling thread only; must outlive this object.
	Execution(int threads, Progress& progress);
	~Execution();
	Execution(const Execution&) = delete;
	Execution& operator=(const Execution&) = delete;

	int threads() const { return threads_; }

	/// Loops that follow report fractions between `begin` and `end` of the whole, with these words.
	/// Reports at once; throws Cancelled.
	void begin_phase(double begin, double end, std::string words);

	/// Loops that follow are part `part` (from 0) of `parts` equal ones of the phase, or so many of
	/// them from there on. Throws Cancelled.
	void begin_part(int part, int parts, int count = 1);

	/// Runs the body over [0, count) in parts of `grain` indices. Small loops run on the calling
	/// thread. Throws Cancelled once the caller asked to stop, after all workers have halted; an
	/// exception of the body ends the loop the same way and is thrown on.
	void parallel_for(Index count, Index grain, const Body& body);

	/// Calls body(i) for every index in [0, count), many of them at a time on a thread.
	template<class EachBody>
	void for_each(Index count, EachBody body)
	{
		parallel_for(count, EACH_GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i)
				body(static_cast<std::size_t>(i));
		});
	}

	/// Sum of term(i) over [0, count), added up in an order that does not depend on the threads.
	double sum(Index count, const std::function<double(Index)>& term);

private:
	/// Some tens of microseconds of a few dozen operations each.
	static constexpr Index EACH_GRAIN = 2048;

	class Workers;
	void poll(double fraction_of_part);

	Progress& progress_;
	int threads_;
	std::unique_ptr<Workers> workers_;
	double phase_begin_ = 0;
	double phase_end_ = 0;
	double part_begin_ = 0;
	double part_length_ = 1;
	std::string words_;
	std::chrono::steady_clock::time_point last_report_;
};

} // namespace orthopoly
