#include "pdx/pd/cloud_term.hpp"

#include "pdx/base/error.hpp"
#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/geom/cell_grid.hpp"
#include "pdx/pd/site_directory.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace pdx::pd {
namespace {
/// Numbers of the others within `reach` [m] of one of mine.
template <int Dim> std::vector<Index> others_near(const Cloud<Dim>& cloud, std::span<const Index> mine, double reach)
{
  std::vector<Index> others;
  if (mine.empty()) return others;
  std::vector<Vector<Dim>> points;
  std::vector<std::uint8_t> owned(cloud.points.size(), 0);
  geom::Box<Dim> box{cloud.points[static_cast<std::size_t>(mine[0])], cloud.points[static_cast<std::size_t>(mine[0])]};
  for (const Index number : mine) {
    points.push_back(cloud.points[static_cast<std::size_t>(number)]);
    box.lower = box.lower.cwiseMin(points.back()).eval();
    box.upper = box.upper.cwiseMax(points.back()).eval();
    owned[static_cast<std::size_t>(number)] = 1;
  }
  const geom::CellGrid<Dim> grid(points, reach);
  std::vector<Index> near;
  for (std::size_t number = 0; number < owned.size(); ++number) {
    const Vector<Dim>& x = cloud.points[number];
    if (owned[number] || !box.contains(x, reach)) continue;
    grid.near(x, near);
    if (std::ranges::any_of(near, [&](Index k) { return (points[static_cast<std::size_t>(k)] - x).norm() <= reach; }))
      others.push_back(static_cast<Index>(number));
  }
  return others;
}

/// This rank's part of a cloud.
template <int Dim> struct LocalCloud {
  std::vector<Index> numbers;      // of all particles here
  std::vector<PetscInt> halo_rows; // of those behind mine, ascending
  Cloud<Dim> cloud;

  LocalCloud(const field::Rows& rows, const Cloud<Dim>& whole, std::span<const Index> mine, const CloudOptions& options)
      : numbers(mine.begin(), mine.end())
  {
    const double largest = *std::ranges::max_element(whole.volumes);
    const std::vector<Index> others = others_near(whole, mine, bond_reach<Dim>(options, largest));
    const SiteDirectory directory(rows.comm, static_cast<Index>(whole.points.size()), mine, rows.first);
    const std::vector<PetscInt> found = directory.rows(others);
    std::vector<std::pair<PetscInt, Index>> halo;
    for (std::size_t k = 0; k < others.size(); ++k) halo.emplace_back(found[k], others[k]);
    std::ranges::sort(halo);
    for (const auto& [row, number] : halo) {
      halo_rows.push_back(row);
      numbers.push_back(number);
    }
    for (const Index number : numbers) {
      cloud.points.push_back(whole.points[static_cast<std::size_t>(number)]);
      cloud.volumes.push_back(whole.volumes[static_cast<std::size_t>(number)]);
    }
  }
};

/// Makes what any rank refuses an error of all ranks.
template <int Dim>
CsrPart<Dim> make_part(MPI_Comm comm, const LocalCloud<Dim>& local, Index owned, const CloudOptions& options)
{
  CsrPart<Dim> part({}, 0, options);
  std::string message;
  try {
    part = CsrPart<Dim>(local.cloud, owned, options, local.numbers);
  } catch (const UserError& wrong) {
    message = wrong.what() + std::string("\n");
  }
  const std::vector<char> all = gather_all(comm, std::vector<char>(message.begin(), message.end()));
  if (!all.empty()) throw UserError(std::string(all.begin(), std::ranges::find(all, '\n')));
  return part;
}
} // namespace

template <int Dim>
CloudTerm<Dim>::CloudTerm(const field::Rows& rows, const Cloud<Dim>& cloud, std::span<const Index> mine,
                          const CloudOptions& options, Kinematics kinematics)
    : rows_(rows), kinematics_(kinematics), density_(options.elastic.density), part_({}, 0, options)
{
  PDX_ASSERT(rows.owned() == static_cast<Index>(mine.size()) && rows.first_particle() == 0);
  const LocalCloud<Dim> local(rows, cloud, mine, options);
  part_ = make_part<Dim>(rows.comm, local, rows.owned(), options);
  halo_rows_ = local.halo_rows;
  std::int64_t most = 0;
  const std::span<const std::int64_t> first = part_.view().first;
  for (std::size_t i = 0; i + 1 < first.size(); ++i) most = std::max(most, first[i + 1] - first[i]);
  MPI_Allreduce(MPI_IN_PLACE, &most, 1, MPI_INT64_T, MPI_MAX, rows.comm);
  if (most == 0) throw no_neighbours(options.horizon);
  words_ = static_cast<int>((most + 63) / 64);
  whole_ = start_ = part_.bonded_volume();
}

template <int Dim> void CloudTerm<Dim>::needed_rows(std::vector<PetscInt>& rows) const
{
  rows.insert(rows.end(), halo_rows_.begin(), halo_rows_.end());
}

template <int Dim> void CloudTerm<Dim>::bind(const field::RowHalo& halo)
{
  if (static_cast<std::size_t>(halo.size()) != owned() + halo_rows_.size())
    throw std::logic_error("a cloud stands beside nothing else");
}

template <int Dim> void CloudTerm<Dim>::add_residual(std::span<const double> u, std::span<double> r) const
{
  static Event event("pd_force");
  Timed timed(event);
  seen_ = part_.add_force(kinematics_, critical_stretch_, u, r).overstretched;
}

template <int Dim> double CloudTerm<Dim>::energy(std::span<const double> u) const
{
  std::vector<double> unused(owned() * Dim, 0.0);
  return part_.add_force(kinematics_, critical_stretch_, u, unused, true).energy;
}

template <int Dim> void CloudTerm<Dim>::couplings(field::Couplings&, bool) const
{
  throw std::logic_error("the bonds of a cloud have no tangent");
}

template <int Dim> void CloudTerm<Dim>::add_jacobian(field::BlockAdder&, bool) const
{
  throw std::logic_error("the bonds of a cloud have no tangent");
}

template <int Dim> void CloudTerm<Dim>::add_mass(std::span<double> mass) const
{
  for (std::size_t k = 0; k < owned(); ++k) mass[k] += volumes()[k] * density_;
}

template <int Dim> void CloudTerm<Dim>::add_stiffness_bound(std::span<double> blocks) const
{
  using Place = Eigen::Map<const Vector<Dim>>;
  const CsrView<Dim> view = part_.view();
  for (std::size_t i = 0; i < owned(); ++i) {
    Eigen::Map<Eigen::Matrix<double, Dim, Dim, Eigen::RowMajor>> block(blocks.data() + i * Dim * Dim);
    for (std::int64_t b = view.first[i]; b < view.first[i + 1]; ++b) {
      if (!view.intact[b]) continue;
      const Vector<Dim> along =
          (Place(view.points + view.neighbour[b] * Dim) - Place(view.points + i * Dim)) / view.length[b];
      block += 2.0 * view.weight[b] * along * along.transpose();
    }
  }
}

template <int Dim> std::int64_t CloudTerm<Dim>::cut(const crack::CrackSet& cracks)
{
  static Event event("pd_cut");
  Timed timed(event);
  const std::int64_t count = part_.cut(cracks);
  start_ = part_.bonded_volume();
  return count;
}

template <int Dim> void CloudTerm<Dim>::watch(double critical_stretch, std::span<const geom::Box<2>> no_fail)
{
  critical_stretch_ = critical_stretch;
  no_fail_.clear();
  const double* points = part_.view().points;
  for (std::size_t k = 0; !no_fail.empty() && k < owned() + halo_rows_.size(); ++k)
    no_fail_.push_back(std::ranges::any_of(no_fail, [x = Vector<2>(points[k * Dim], points[k * Dim + 1])](
                                                        const geom::Box<2>& box) { return box.contains(x); }));
}

template <int Dim> Broken CloudTerm<Dim>::break_overstretched(std::span<const double> u, field::ForceLosses& losses)
{
  static Event event("pd_break");
  Timed timed(event);
  return part_.break_bonds({kinematics_, critical_stretch_, no_fail_.empty() ? nullptr : no_fail_.data()}, u, &losses);
}

template <int Dim> std::vector<std::uint64_t> CloudTerm<Dim>::gone() const
{
  const auto width = static_cast<std::size_t>(words_);
  const CsrView<Dim> view = part_.view();
  std::vector<std::uint64_t> words(owned() * width, 0);
  for (std::size_t i = 0; i < owned(); ++i)
    for (auto b = view.first[i], k = std::int64_t{0}; b < view.first[i + 1]; ++b, ++k)
      words[i * width + static_cast<std::size_t>(k / 64)] |= std::uint64_t{!view.intact[b]} << k % 64;
  return words;
}

template <int Dim> void CloudTerm<Dim>::set_gone(std::span<const std::uint64_t> words)
{
  const auto width = static_cast<std::size_t>(words_);
  const std::span<const std::int64_t> first = part_.view().first;
  std::vector<std::uint8_t> intact(part_.intact().size());
  for (std::size_t i = 0; i < owned(); ++i)
    for (auto b = first[i], k = std::int64_t{0}; b < first[i + 1]; ++b, ++k)
      intact[static_cast<std::size_t>(b)] = ~words[i * width + static_cast<std::size_t>(k / 64)] >> k % 64 & 1u;
  part_.keep_only(intact);
}

template <int Dim> std::vector<BondedVolume> CloudTerm<Dim>::bonded_volume() const
{
  const std::vector<double> now = part_.bonded_volume();
  std::vector<BondedVolume> volumes;
  for (std::size_t k = 0; k < now.size(); ++k) volumes.push_back({whole_[k], start_[k], now[k]});
  return volumes;
}

template class CloudTerm<2>;
template class CloudTerm<3>;
} // namespace pdx::pd
