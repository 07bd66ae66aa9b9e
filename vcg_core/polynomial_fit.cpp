// SPDX-License-Identifier: GPL-3.0-or-later
#include "polynomial_fit.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Faces a thread takes at a time when it fits; about half a millisecond of work.
constexpr Index FIT_GRAIN = 32;

// Votes are kept for so many fits at a time before their faces gather them: about 70 of 32 bytes
// each at the default rings, two megabytes in all however large the mesh.
constexpr Index BLOCK = 1024;

// Faces a thread takes at a time when the votes are gathered.
constexpr Index SMALLEST_GATHER_GRAIN = 4096;

// Sum of what one fit says about one face.
struct Vote {
	Index face;
	Point sum;
};

// Fits and keeps the votes; one object per thread.
class Voter {
public:
	// Where the votes of one fit are, and the range of the faces they are for.
	struct Ballot {
		const Voter* voter = nullptr;
		std::size_t begin = 0;
		std::size_t end = 0;
		Index lowest_face = 0;
		Index highest_face = -1;

		const Vote* first() const { return voter->votes_.data() + begin; }
		const Vote* last() const { return voter->votes_.data() + end; }
	};

	Voter(
		const SimilarStructures& structures,
		const PolynomialFitOptions& options,
		Index face_count) :
			structures_(structures),
			fit_(options), places_(at(face_count), -1)
	{
	}

	void clear() { votes_.clear(); }

	Ballot vote(Index face, const std::vector<Point>& normals)
	{
		Ballot ballot;
		ballot.voter = this;
		ballot.begin = votes_.size();
		structures_.collect(face);
		const std::vector<Index>& rows = structures_.faces();
		fit_.fit(normals, rows);
		const std::vector<Point>& values = fit_.values();
		for (std::size_t row = 0; row < values.size(); ++row) {
			Index& place = places_[at(rows[row])];
			if (place < 0) {
				place = static_cast<Index>(votes_.size() - ballot.begin);
				votes_.push_back({rows[row], values[row]});
			}
			else {
				votes_[ballot.begin + at(place)].sum += values[row];
			}
		}
		ballot.end = votes_.size();
		if (ballot.end > ballot.begin)
			ballot.lowest_face = ballot.highest_face = votes_[ballot.begin].face;
		for (std::size_t k = ballot.begin; k < ballot.end; ++k) {
			const Index voted = votes_[k].face;
			places_[at(voted)] = -1;
			ballot.lowest_face = std::min(ballot.lowest_face, voted);
			ballot.highest_face = std::max(ballot.highest_face, voted);
		}
		return ballot;
	}

private:
	SimilarStructures structures_;
	PolynomialFit fit_;
	// #F places in the votes of the fit under way, or -1.
	std::vector<Index> places_;
	std::vector<Vote> votes_;
};

} // namespace

MatrixShape near_square_shape(int count)
{
	if (count < 1)
		return {};
	MatrixShape shape;
	shape.rows = static_cast<int>(std::sqrt(static_cast<double>(count)));
	shape.columns = count / shape.rows;
	return shape;
}

PolynomialFit::PolynomialFit(const PolynomialFitOptions& options) :
		bases_x_(options.order_x), bases_y_(options.order_y)
{
}

void PolynomialFit::fit(const std::vector<Point>& normals, const std::vector<Index>& rows)
{
	const MatrixShape shape = near_square_shape(static_cast<int>(rows.size()));
	values_.resize(at(shape.rows) * at(shape.columns));
	if (values_.empty())
		return;
	const Eigen::MatrixXd& B_x = bases_x_.basis(shape.columns);
	const Eigen::MatrixXd& B_y = bases_y_.basis(shape.rows);
	const Eigen::Index x_degrees = B_x.cols();
	const Eigen::Index y_degrees = B_y.cols();
	const auto coefficient = [&](Eigen::Index x_degree, Eigen::Index y_degree) -> Point& {
		return coefficients_[static_cast<std::size_t>(x_degree * y_degrees + y_degree)];
	};

	// Eq. 11, right to left in the middle and outwards from there: C = B_y^T R B_x ...
	coefficients_.assign(static_cast<std::size_t>(x_degrees * y_degrees), Point::Zero());
	const Index* row = rows.data();
	for (int column = 0; column < shape.columns; ++column) {
		column_.assign(static_cast<std::size_t>(y_degrees), Point::Zero());
		for (int k = 0; k < shape.rows; ++k, ++row) {
			for (Eigen::Index j = 0; j < y_degrees; ++j)
				column_[static_cast<std::size_t>(j)] += B_y(k, j) * normals[at(*row)];
		}
		for (Eigen::Index i = 0; i < x_degrees; ++i) {
			for (Eigen::Index j = 0; j < y_degrees; ++j)
				coefficient(i, j) += B_x(column, i) * column_[static_cast<std::size_t>(j)];
		}
	}
	// ... and Z = B_y C B_x^T.
	Point* value = values_.data();
	for (int column = 0; column < shape.columns; ++column) {
		column_.assign(static_cast<std::size_t>(y_degrees), Point::Zero());
		for (Eigen::Index i = 0; i < x_degrees; ++i) {
			for (Eigen::Index j = 0; j < y_degrees; ++j)
				column_[static_cast<std::size_t>(j)] += B_x(column, i) * coefficient(i, j);
		}
		for (int k = 0; k < shape.rows; ++k, ++value) {
			*value = B_y(k, 0) * column_[0];
			for (Eigen::Index j = 1; j < y_degrees; ++j)
				*value += B_y(k, j) * column_[static_cast<std::size_t>(j)];
		}
	}
}

std::vector<Point> filter_normals(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& guides,
	const PolynomialFilterOptions& options)
{
	Execution& execution = workspace.execution;
	const Index face_count = workspace.mesh.face_count();
	const IndexLists isotropic =
		isotropic_structures(workspace, normals, guides, options.structures);
	std::vector<Voter> voters(
		at(execution.threads()),
		Voter(
			SimilarStructures(workspace, guides, isotropic, options.structures),
			options.fit,
			face_count));
	const Index gather_grain =
		std::max(SMALLEST_GATHER_GRAIN, face_count / (4 * static_cast<Index>(execution.threads())));

	std::vector<Point> filtered(at(face_count), Point::Zero());
	std::vector<Voter::Ballot> ballots(at(std::min(BLOCK, face_count)));
	const Index blocks = (face_count + BLOCK - 1) / BLOCK;
	for (Index block = 0; block < blocks; ++block) {
		execution.begin_part(block, blocks);
		const Index first = block * BLOCK;
		const Index count = std::min(BLOCK, face_count - first);
		for (Voter& voter : voters)
			voter.clear();
		execution.parallel_for(count, FIT_GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i)
				ballots[at(i)] = voters[at(worker)].vote(first + i, normals);
		});
		// Every face gathers its own votes, in the order of the fits whoever made them: the same
		// sum on any number of threads.
		execution.parallel_for(face_count, gather_grain, [&](Index begin, Index end, int) {
			for (Index i = 0; i < count; ++i) {
				const Voter::Ballot& ballot = ballots[at(i)];
				if (ballot.highest_face < begin || ballot.lowest_face >= end)
					continue;
				for (const Vote* vote = ballot.first(); vote != ballot.last(); ++vote) {
					if (vote->face >= begin && vote->face < end)
						filtered[at(vote->face)] += vote->sum;
				}
			}
		});
	}
	for (std::size_t i = 0; i < filtered.size(); ++i) {
		const double length = filtered[i].norm();
		filtered[i] = length > 0 ? Point(filtered[i] / length) : normals[i];
	}
	return filtered;
}

} // namespace orthopoly
