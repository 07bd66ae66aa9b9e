// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <utility>

namespace orthopoly {

/// Tells a caller how far the work is, and lets it stop the work. The callback is only ever
/// called from the thread that started the work; the percentages never fall.
class Progress {
public:
	/// Takes a percentage (0 to 100) and words for it; false asks for the work to stop.
	using Callback = std::function<bool(int percent, const std::string& words)>;

	Progress() = default;
	explicit Progress(Callback callback) : callback_(std::move(callback)) {}

	/// Reports a fraction of the whole (0 to 1). Returns false once the caller has asked to stop.
	bool report(double fraction, const std::string& words)
	{
		const int percent = static_cast<int>(100.0 * fraction);
		if (percent > percent_)
			percent_ = percent < 100 ? percent : 100;
		if (callback_ && !cancelled_)
			cancelled_ = !callback_(percent_, words);
		return !cancelled_;
	}

	bool cancelled() const { return cancelled_; }

private:
	Callback callback_;
	int percent_ = 0;
	bool cancelled_ = false;
};

} // namespace orthopoly
