// SPDX-License-Identifier: GPL-3.0-or-later
// Times `denoise` in one process: denoise_timer MESH METHOD THREADS REPEATS BUDGET
//
// Denoises the mesh once to warm up, which is also when memory is measured, then REPEATS times, or
// until BUDGET seconds have gone by. Prints JSON: the seconds of each time, the memory at the peak
// beyond what the process held with the mesh loaded, and the share of each step.
#include "denoise.h"
#include "mesh_io.h"
#include "parameters.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using namespace orthopoly;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start)
{
	return std::chrono::duration<double>(Clock::now() - start).count();
}

// Adds up the time between one report and the next under the words of the first.
class StepTimes {
public:
	Progress progress()
	{
		last_ = Clock::now();
		words_ = "start";
		return Progress([this](int, const std::string& words) {
			add();
			words_ = words;
			return true;
		});
	}

	void finish() { add(); }

	nlohmann::json shares() const
	{
		double all = 0;
		for (const auto& [step, seconds] : seconds_)
			all += seconds;
		nlohmann::json shares = nlohmann::json::object();
		for (const auto& [step, seconds] : seconds_)
			shares[step] = seconds / all;
		return shares;
	}

private:
	void add()
	{
		// "iteration 2 of 5: fitting normals" is the same step in every iteration.
		const std::size_t colon = words_.find(": ");
		seconds_[colon == std::string::npos ? words_ : words_.substr(colon + 2)] +=
			seconds_since(last_);
		last_ = Clock::now();
	}

	std::map<std::string, double> seconds_;
	std::string words_;
	Clock::time_point last_;
};

// A line of /proc/self/status, in bytes; -1 where there is none.
long long process_memory(const std::string& name)
{
	std::ifstream status("/proc/self/status");
	std::string word;
	while (status >> word) {
		long long kibibytes = 0;
		if (word == name + ":" && status >> kibibytes)
			return 1024 * kibibytes;
	}
	return -1;
}

// Gives back what loading left behind and starts the peak anew; false where the system has no such.
bool reset_peak()
{
#ifdef __GLIBC__
	malloc_trim(0);
#endif
	std::ofstream refs("/proc/self/clear_refs");
	refs << "5" << std::flush;
	return refs.good();
}

void run(const std::vector<std::string>& words)
{
	if (words.size() != 5)
		throw std::invalid_argument("usage: denoise_timer MESH METHOD THREADS REPEATS BUDGET");
	const TriangleMesh mesh = load_mesh(words[0]);
	DenoiseOptions options;
	set_parameter(denoise_parameters(), "method", words[1], options);
	set_parameter(denoise_parameters(), "threads", words[2], options);
	const int repeats = std::stoi(words[3]);
	const double budget = std::stod(words[4]);

	nlohmann::json json = {{"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}};
	const bool measurable = reset_peak();
	const long long before = process_memory("VmRSS");
	std::vector<double> seconds;
	StepTimes steps;
	const Clock::time_point first = Clock::now();
	while (static_cast<int>(seconds.size()) <= repeats) {
		// Always one that counts after the one that warms up.
		if (seconds.size() > 1 && seconds_since(first) > budget)
			break;
		Progress progress = steps.progress();
		const Clock::time_point start = Clock::now();
		const DenoiseResult result = denoise(mesh, options, progress);
		seconds.push_back(seconds_since(start));
		steps.finish();
		if (result.status == DenoiseResult::Status::Cancelled)
			throw std::runtime_error("denoise was cancelled by nobody");
		if (seconds.size() == 1) {
			const long long peak = process_memory("VmHWM");
			json["memory"] = measurable && before > 0 && peak > 0 ? nlohmann::json(peak - before) :
																	nlohmann::json();
			json["estimated_noise"] = result.estimated_noise;
		}
	}
	json["first"] = seconds.front();
	json["seconds"] = std::vector<double>(seconds.begin() + (seconds.size() > 1), seconds.end());
	json["shares"] = steps.shares();
	std::cout << json.dump() << "\n";
}

} // namespace

int main(int argc, char** argv)
{
	try {
		run(std::vector<std::string>(argv + 1, argv + argc));
	}
	catch (const std::exception& error) {
		std::cerr << "denoise_timer: " << error.what() << "\n";
		return 1;
	}
	return 0;
}
