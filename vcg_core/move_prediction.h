// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "local_heights.h"
#include "moves.h"

#include <Eigen/Core>
#include <vector>

namespace orthopoly {

/// What a vertex's move was to be by those of its neighbours.
struct PredictedMove {
	/// In deviations of the noise.
	double length = 0;
	/// Share of the variance of the moves around that is predicted; about zero where they are
	/// noise.
	double share = 0;
	/// Share of what is left of it by the plain sum alone, where moves alternate, that the
	/// directions predict: about zero where any neighbour tells as much as any other, as where each
	/// vertex makes up for those around it.
	double directed_share = 0;
	/// Mean square of the moves around.
	double square = 0;
};

/// Predicts moves of vertices from those of their neighbours, whichever way these lie.
///
/// A ridge or a groove as narrow as the triangles goes together along itself and alternates across,
/// so that neighbours have nothing in common on average. A move is predicted as a linear function
/// of three sums over the neighbours' moves, plain and times the cosine and the sine of twice the
/// direction that each lies in, with a constant: the one that leaves the least squares within a few
/// rings (linear prediction). Noise, each vertex's its own, is not predicted. Keeps scratch memory
/// (4 bytes a vertex), so use one object a thread.
class MovePredictor {
public:
	/// The moves of a vertex's neighbours, each times the square of the direction it lies in: xx,
	/// yy, zz, xy, yz, zx; mean over the faces around.
	using DirectedMoves = Eigen::Matrix<double, 6, 1>;

	/// #V. O(#V) time.
	static std::vector<DirectedMoves> directed_moves(
		const Workspace& workspace,
		const std::vector<Point>& positions,
		const std::vector<double>& lengths);

	/// All must outlive the predictor.
	MovePredictor(
		const Workspace& workspace,
		const Moves& moves,
		const std::vector<DirectedMoves>& directed) :
			moves_(moves),
			directed_(directed), rings_(workspace)
	{
	}

	/// Zero where there is no normal, and where too few vertices are around.
	PredictedMove predict(Index vertex);

private:
	const Moves& moves_;
	const std::vector<DirectedMoves>& directed_;
	VertexRings rings_;
};

} // namespace orthopoly
