// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// How much of a mesh lies on a grid of cubes, as one that was extracted from a volume does
/// (marching cubes, Lorensen and Cline 1987): fused depth images, tomography, reconstructions.
///
/// There every vertex is on an edge of a cube and most edges of the mesh are in the faces of
/// cubes, hence across one of the grid's three axes, whatever noise is in the volume. Axes are
/// found as what many pairs of edges are across to, so that the grid may lie any way.
///
/// Returns the share of the edges that are across an axis, for the axis that has the fewest: 0.2
/// and more on such meshes, smoothed or decimated ones left out, below 0.04 on other noisy ones.
/// Boxes whose noise is along their faces' normals are on a grid as well, and so are clean ones.
/// Zero without edges. O(#F) time.
double voxel_share(const Workspace& workspace, const std::vector<Point>& positions);

} // namespace orthopoly
