#pragma once
#include "pdx/mpm/point_term.hpp"
#include "support/ranks.hpp"

#include <functional>
#include <memory>

namespace pdx::test {
/// A body of material points on cells of a box, one PointTerm. Nodes are dealt to ranks in slices, cells in turn: who
/// gives a cell need not own its corners.
template <int Dim> class PointBody {
public:
  using Mask = std::function<std::uint64_t(const Site<Dim>& cell)>;
  using Field = std::function<Vector<Dim>(const Vector<Dim>& x)>;

  /// @param mask points of each cell, none: no cell; empty: all full   Collective.
  PointBody(MPI_Comm comm, const Site<Dim>& cells, const mpm::BodyMaterial& body, const Mask& mask = {}) : body_(body)
  {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &ranks);
    std::vector<mpm::PointCell<Dim>> all;
    std::vector<Vector<Dim>> places;
    std::vector<Index> node_of = number_nodes(cells, mask, all, places);
    const auto total = static_cast<Index>(places.size());
    const Index begin = total * rank / ranks, end = total * (rank + 1) / ranks;
    rows_ = field::Rows::number(comm, Dim, end - begin, 0, 0);
    nodes_.assign(places.begin() + begin, places.begin() + end);
    std::vector<mpm::PointCell<Dim>> mine;
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (static_cast<int>(k * 7 / 3) % ranks != rank) continue;
      mine.push_back(all[k]);
      corners_.push_back(places[static_cast<std::size_t>(all[k].rows[0])]);
    }
    term_ = std::make_unique<mpm::PointTerm<Dim>>(rows_, mine, std::vector{body});
    std::vector<PetscInt> needed;
    term_->needed_rows(needed);
    halo_ = std::make_unique<field::RowHalo>(rows_, std::move(needed));
    term_->bind(*halo_);
  }

  mpm::PointTerm<Dim>& term() const { return *term_; }
  const field::Rows& rows() const { return rows_; }
  const field::RowHalo& halo() const { return *halo_; }
  const std::vector<Vector<Dim>>& nodes() const { return nodes_; }     ///< owned [m]
  const std::vector<Vector<Dim>>& corners() const { return corners_; } ///< lowest of this rank's cells [m]

  /// A field at [owned | halo] rows. Collective.
  std::vector<double> blocks(const Field& f) const
  {
    std::vector<double> owned, all;
    for (const Vector<Dim>& x : nodes_)
      for (int d = 0; d < Dim; ++d) owned.push_back(f(x)[d]);
    halo_->fetch(owned, Dim, all);
    return all;
  }
  /// Internal force of owned rows [N].
  std::vector<double> force(const std::vector<double>& u) const
  {
    std::vector<double> r(nodes_.size() * Dim, 0.0);
    term_->add_residual(u, r);
    return r;
  }
  std::vector<double> mass() const
  {
    std::vector<double> m(nodes_.size(), 0.0);
    term_->add_mass(m);
    return m;
  }

private:
  std::vector<Index> number_nodes(const Site<Dim>& cells, const Mask& mask, std::vector<mpm::PointCell<Dim>>& all,
                                  std::vector<Vector<Dim>>& places) const
  {
    const auto nodes_before = [&](int d) {
      Index n = 1;
      for (int e = 0; e < d; ++e) n *= cells[static_cast<std::size_t>(e)] + 1;
      return n;
    };
    std::vector<Index> number(static_cast<std::size_t>(nodes_before(Dim)), -1);
    Index count = 1;
    for (const Index n : cells) count *= n;
    for (Index k = 0; k < count; ++k) {
      Site<Dim> site;
      Index first = 0, rest = k;
      for (int d = 0; d < Dim; ++d) {
        site[static_cast<std::size_t>(d)] = rest % cells[static_cast<std::size_t>(d)];
        rest /= cells[static_cast<std::size_t>(d)];
        first += site[static_cast<std::size_t>(d)] * nodes_before(d);
      }
      mpm::PointCell<Dim> cell{0, {}, mask ? mask(site) : mpm::full_mask<Dim>(body_.ratio)};
      if (!cell.points) continue;
      for (int a = 0; a < mpm::kCorners<Dim>; ++a) {
        Index node = first;
        for (int d = 0; d < Dim; ++d) node += (a >> d & 1) * nodes_before(d);
        cell.rows[static_cast<std::size_t>(a)] = node;
        number[static_cast<std::size_t>(node)] = 0;
      }
      all.push_back(cell);
    }
    for (std::size_t node = 0; node < number.size(); ++node) {
      if (number[node] < 0) continue;
      number[node] = static_cast<Index>(places.size());
      Vector<Dim> place;
      auto rest = static_cast<Index>(node);
      for (int d = 0; d < Dim; ++d) {
        place[d] = body_.side() * (rest % (cells[static_cast<std::size_t>(d)] + 1));
        rest /= cells[static_cast<std::size_t>(d)] + 1;
      }
      places.push_back(place);
    }
    for (mpm::PointCell<Dim>& cell : all)
      for (PetscInt& row : cell.rows) row = number[static_cast<std::size_t>(row)];
    return number;
  }

  mpm::BodyMaterial body_;
  field::Rows rows_;
  std::vector<Vector<Dim>> nodes_, corners_;
  std::unique_ptr<mpm::PointTerm<Dim>> term_;
  std::unique_ptr<field::RowHalo> halo_;
};

/// Any mask but none, another for each cell.
template <int Dim> std::uint64_t mixed_mask(const Site<Dim>& cell, int ratio)
{
  std::uint64_t number = 88172645463325252ULL;
  for (const Index i : cell) number = (number ^ static_cast<std::uint64_t>(i + 1)) * 0x9e3779b97f4a7c15ULL;
  number ^= number >> 29;
  const std::uint64_t mask = number & mpm::full_mask<Dim>(ratio);
  return mask ? mask : 1;
}
} // namespace pdx::test
