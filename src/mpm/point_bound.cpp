#include "pdx/mpm/point_term.hpp"
#include "shared_faces.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::mpm {
namespace {
constexpr int kPasses = 4;
constexpr double kMove = 1.5;  // exponent of a pass: weights go by the load before, to its power
constexpr double kSame = 1e-9; // of the load inside a full body

/// Loads of nodes: what cells at given weights of their corners put on them, over what a Laplacian would inside a full
/// body. Weighted, not measured in mass: a body without density has some too.
template <int Dim> class Loads {
public:
  Loads(const field::RowHalo& halo, std::span<const PointCell<Dim>> cells, std::span<const LocalCell<Dim>> local,
        std::span<const BodyMaterial> bodies, const PointPatterns<Dim>& patterns)
      : halo_(halo), cells_(cells), local_(local), patterns_(patterns),
        shared_(find_shared_faces<Dim>(halo.rows(), cells, bodies)),
        weights_(static_cast<std::size_t>(halo.size()), 1.0)
  {
    for (const BodyMaterial& body : bodies) {
      bounds_.emplace_back(body);
      const double modulus = law_tangent<Dim>(body, Tensor<Dim>::Zero())(0, 0);
      corner_.push_back(point_volume<Dim>(body) * std::pow(body.ratio, Dim) / kCorners<Dim>);
      inside_.push_back(4.0 * modulus / (body.side() * body.side()) * corner_.back());
    }
    volumes_ = on_nodes([&](std::size_t k, const CellPoints<Dim>& points) -> CornerValues<Dim> {
      return points.shares / corner_[static_cast<std::size_t>(cells_[k].body)];
    });
  }

  /// Of owned rows at the present weights, over what is inside [-].
  std::vector<double> loads()
  {
    return on_nodes([&](std::size_t k, const CellPoints<Dim>& points) -> CornerValues<Dim> {
      const auto body = static_cast<std::size_t>(cells_[k].body);
      CornerValues<Dim> weights = points.shares / corner_[body];
      for (std::size_t a = 0; a < local_[k].rows.size(); ++a)
        weights[static_cast<Eigen::Index>(a)] *= weights_[static_cast<std::size_t>(local_[k].rows[a])];
      return bounds_[body].stiffest(points, shared_[k], weights) / inside_[body] * weights;
    });
  }
  double per_volume(const std::vector<double>& loads, std::size_t row) const { return loads[row] / volumes_[row]; }
  /// Largest of all ranks. Collective.
  double worst(const std::vector<double>& loads) const
  {
    double most = 0.0;
    for (std::size_t row = 0; row < loads.size(); ++row)
      if (volumes_[row] > 0.0) most = std::max(most, per_volume(loads, row));
    MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_DOUBLE, MPI_MAX, halo_.rows().comm);
    return most;
  }
  /// Who has much for its volume gets less weight. Collective.
  void move_weights(const std::vector<double>& loads)
  {
    std::vector<double> owned(loads.size(), 1.0);
    for (std::size_t row = 0; row < loads.size(); ++row) {
      if (volumes_[row] == 0.0) continue;
      const double load = per_volume(loads, row);
      owned[row] = weights_[row] * (std::abs(load - 1.0) < kSame ? 1.0 : std::pow(load, -kMove));
    }
    halo_.fetch(owned, 1, weights_);
  }
  double volume(std::size_t row) const { return volumes_[row]; } ///< of an owned row, in corners [-]
  double inside(Index body) const { return inside_[static_cast<std::size_t>(body)]; }

private:
  template <class OfCell> std::vector<double> on_nodes(OfCell&& of_cell) const
  {
    std::vector<double> all(static_cast<std::size_t>(halo_.size()), 0.0);
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const CornerValues<Dim> values = of_cell(k, patterns_.at(cells_[k].body, cells_[k].points));
      for (std::size_t a = 0; a < local_[k].rows.size(); ++a)
        all[static_cast<std::size_t>(local_[k].rows[a])] += values[static_cast<Eigen::Index>(a)];
    }
    halo_.reduce(all, 1);
    all.resize(static_cast<std::size_t>(halo_.rows().owned()));
    return all;
  }

  const field::RowHalo& halo_;
  std::span<const PointCell<Dim>> cells_;
  std::span<const LocalCell<Dim>> local_;
  const PointPatterns<Dim>& patterns_;
  std::vector<SharedParts<Dim>> shared_;
  std::vector<CellBounds<Dim>> bounds_; ///< per body
  std::vector<double> corner_, inside_; ///< per body: volume of a corner of a full cell [m^3], load inside on it [N/m]
  std::vector<double> weights_;         ///< of local rows [-]
  std::vector<double> volumes_;         ///< of owned rows, in corners [-]
};

/// Of the load of a row, so that viscous forces that lag half a step behind are stable as well: dt^2 K + 2 dt C <= 4 M,
/// and C is at most b h / c times K. @param b with `viscous_share`
double with_viscosity(double load, double volume, double b)
{
  if (b == 0.0 || load == 0.0) return load;
  const double step = std::sqrt(b * b + volume / load) - b; // in h / c
  return volume / (step * step);
}
/// What (lambda + 2 mu) tr(e)^2 is of lambda tr(e)^2 + 2 mu e:e at most: where all directions grow alike.
template <int Dim> double viscous_share(const BodyMaterial& body)
{
  const law::Tangent<Dim> rest = law_tangent<Dim>(body, Tensor<Dim>::Zero());
  const double along = rest(0, 0), across = rest(0, Dim + 1); // lambda + 2 mu, lambda
  return along / (across + (along - across) / Dim);
}
} // namespace

template <int Dim> void PointTerm<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  Loads<Dim> all(*halo_, cells_, local_, materials_, patterns_);
  std::vector<double> least;
  double worst = 0.0;
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<double> loads = all.loads();
    const double now = all.worst(loads);
    if (pass == 0 || now < worst) {
      worst = now;
      least = loads;
    }
    all.move_weights(loads);
  }
  std::vector<std::uint8_t> done(least.size(), 0);
  for (const LocalCell<Dim>& cell : local_)
    for (const Index row : cell.rows) {
      if (row >= owned_rows_ || done[static_cast<std::size_t>(row)]) continue;
      done[static_cast<std::size_t>(row)] = 1;
      const auto k = static_cast<std::size_t>(row);
      const double load = with_viscosity(least[k], all.volume(k), viscosity_ * viscous_share<Dim>(material(cell.body)));
      double* const block = blocks.data() + static_cast<std::ptrdiff_t>(row) * Dim * Dim;
      for (int d = 0; d < Dim; ++d) block[d * (Dim + 1)] += load * all.inside(cell.body);
    }
}

template void PointTerm<2>::add_stiffness_bound(std::span<double>) const;
template void PointTerm<3>::add_stiffness_bound(std::span<double>) const;
} // namespace pdx::mpm
