// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter.h"

#include "angular_error_filter.h"
#include "denoise_filter.h"
#include "errors.h"
#include "execution.h"
#include "noise_filter.h"

#include <new>

namespace orthopoly {

const std::vector<const Filter*>& filters()
{
	static const DenoiseFilter denoise;
	static const AngularErrorFilter angular_error;
	static const NoiseFilter noise;
	static const std::vector<const Filter*> all = {&denoise, &angular_error, &noise};
	return all;
}

void apply_filter(const Filter& filter, FilterRun& run)
{
	try {
		filter.apply(run);
	}
	catch (const Error&) {
		throw;
	}
	catch (const Cancelled&) {
		throw Error("stopped on request; the mesh is unchanged");
	}
	catch (const std::bad_alloc&) {
		throw Error(
			"there is not enough memory for this mesh; the mesh is unchanged: simplify it, or work on "
			"parts of it");
	}
	catch (const std::exception& error) {
		throw Error(std::string("unexpected error: ") + error.what());
	}
	catch (...) {
		throw Error("unexpected error without a description");
	}
}

} // namespace orthopoly
