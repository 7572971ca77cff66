#pragma once
#include "pdx/base/options.hpp"
#include "pdx/geom/outline.hpp"

#include <string>
#include <vector>

namespace pdx::options {
/// Sides of the polygon that an option lists the corners of [m]; none: the option is not given. Throws UserError, if it
/// crosses itself too.
std::vector<geom::Outline::Edge> read_polygon(Options& o, const std::string& name);
} // namespace pdx::options
