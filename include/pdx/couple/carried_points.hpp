#pragma once
#include "pdx/couple/surroundings.hpp"
#include "pdx/field/rows.hpp"

namespace pdx::couple {
/// Points that rows carry: displacement by interpolation, d = C u (`spread`, `displacement`), force back by the
/// transpose, f += C^T f (`add_force`).  [XPD1 Eqs. 14-18]. Ghost particles in elements, points of the interface and
/// particles themselves (one row, weight 1) are all carried points; bonds between them never ask which.
template <int Dim> class CarriedPoints {
public:
  /// Adds a point; rows are global until `bind`.
  Index add(const Host& host);
  Index size() const { return static_cast<Index>(offsets_.size()) - 1; }
  std::span<const Index> rows(Index point) const;
  std::span<const double> weights(Index point) const;
  std::span<const double> tied_weights(Index point) const; ///< `Host::tied`
  /// Global rows of all points.
  const std::vector<Index>& all_rows() const { return rows_; }
  void bind(const field::RowHalo& halo); ///< global rows become local ones
  /// Local rows are others from now on. @param now of each local row before
  void move_rows(std::span<const Index> now)
  {
    for (Index& row : rows_) row = now[static_cast<std::size_t>(row)];
  }

  void spread(std::span<const double> u, std::vector<double>& d) const; ///< of all points
  Vector<Dim> displacement(Index point, std::span<const double> u) const;
  void add_force(Index point, const Vector<Dim>& force, Index owned_rows, std::span<double> f) const; ///< to owned rows

private:
  std::vector<std::size_t> offsets_{0};
  std::vector<Index> rows_;
  std::vector<double> weights_, tied_;
};
} // namespace pdx::couple
