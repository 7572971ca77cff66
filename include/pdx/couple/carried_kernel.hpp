#pragma once
#include "pdx/base/processor.hpp"
#include "pdx/base/tensor.hpp"

#include <cstdint>
#include <span>
#include <vector>

/// Forces of bonds from a row to a point that a few rows carry, lanes of bonds at a time.
namespace pdx::couple {
/// Bonds in blocks of 8, padded with ones without stiffness; number l of a block at [8 * ... + l].
template <int Dim> class CarriedLanes {
public:
  static constexpr int kBlock = 8;
  struct Bond {
    Index row = 0;                 ///< of its first end, local
    std::span<const Index> hosts;  ///< rows of its second end, local; at most `width`
    std::span<const double> share; ///< their weights
    Vector<Dim> xi;                ///< from the first to the second [m]
  };

  /// @param width rows of a second end, at most
  explicit CarriedLanes(int width) : width_(width) {}
  int width() const { return width_; }
  void add(std::size_t number, const Bond& bond); ///< @param number the bond's, by which it is told afterwards
  /// Numbers of the bonds, in order.
  std::span<const std::size_t> numbers() const { return numbers_; }
  /// Local rows are others from now on. @param now of each local row before
  void move_rows(std::span<const Index> now)
  {
    for (std::vector<Index>* rows : {&row_, &hosts_})
      for (Index& row : *rows) row = now[static_cast<std::size_t>(row)];
  }
  /// Stiffness of bond k of `numbers`, 0 of one that is gone, and the stretch that is watched for; infinite: none.
  void set(std::size_t k, double kappa, double limit);

  /// r += forces of the bonds on owned rows at displacement u.
  /// @param finite stretch of the turned bond, else along the reference   @return was a limit passed?
  bool add_forces(Processor processor, bool finite, std::span<const double> u, Index owned, std::span<double> r) const;

private:
  template <int D> friend struct SweepCarried;
  int width_;
  std::vector<std::size_t> numbers_;
  std::vector<Index> row_, hosts_;                          // per bond; per block, host and bond
  std::vector<double> share_, xi_, length_, kappa_, limit_; // likewise; xi per block, direction and bond
};
} // namespace pdx::couple
