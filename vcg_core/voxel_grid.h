// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// How much of a mesh lies on a grid of cubes, as one that was extracted from a volume does
/// (marching cubes, Lorensen and Cline 1987): fused depth images, tomography, reconstructions of
/// points.
///
/// There every vertex is on an edge of a cube and most edges of the mesh are in the faces of
/// cubes, hence across one of the grid's three axes, whatever noise is in the volume. Axes are
/// found as what many pairs of edges are across to, so that the grid may lie any way. No edge is
/// longer than a cube's diagonal either.
///
/// Each is the share of the edges that are across an axis, for the axis that has the fewest: of all
/// edges or of those that may move, whichever have the smaller share. Smoothed and decimated meshes
/// are not told.
struct VoxelShares {
	/// Across to within a tenth of a degree: 0.2 and more where vertices are as marching cubes left
	/// them, below 0.04 on other noisy meshes. Boxes whose noise is along their faces' normals are
	/// on a grid as well, and so are clean ones.
	double on = 0;
	/// To within 0.6 degrees: 0.06 to 0.2 where vertices were moved to the noisy surface afterwards
	/// (moving least squares), below 0.06 on other noisy meshes but for boxes.
	double near = 0;
};

/// Measures them. Zero without edges, and where one in ten is over twice as long as the mean. O(#F)
/// time.
VoxelShares voxel_shares(const Workspace& workspace, const std::vector<Point>& positions);

} // namespace orthopoly
