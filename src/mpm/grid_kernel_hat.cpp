#include "grid_kernel_shapes.hpp"
#include "grid_sweep.hpp"

namespace pdx::mpm {
#define PDX_INSTANTIATE(Dim)                                                                                           \
  template void give_with<Dim, Hats>(Processor, const GridRule&, const BodyMaterial&, const Giving&,                   \
                                     const Vector<Dim>&, const PointLanes<Dim>&, const NodeView<Dim>&);                \
  template Vector<Dim> take_with<Dim, Hats>(Processor, const GridRule&, const BodyMaterial&, const Taking&,            \
                                            PointLanes<Dim>&, const NodeView<Dim>&)
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::mpm
