#include "pdx/fem/corner_areas.hpp"

#include "pdx/fem/elastic_kernel.hpp"

namespace pdx::fem {
void CornerAreas::work_out() const
{
  areas_.reserve(static_cast<std::size_t>(mesh_.cells()));
  for (Index c = 0; c < mesh_.cells(); ++c) areas_.push_back(corner_areas(mesh_.corners(c)));
}
} // namespace pdx::fem
