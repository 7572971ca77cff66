#include "pdx/mpm/grid_nodes.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx::mpm {
namespace {
constexpr std::size_t kVectorOfNodes = 8; // lists are whole vectors
constexpr int kTag = 0x67;

template <int Dim> struct NodeEnds {
  Site<Dim> lower, upper;
};
} // namespace

template <int Dim>
GridNodes<Dim>::GridNodes(MPI_Comm comm, const Site<Dim>& lower, const Site<Dim>& upper)
    : comm_(comm), lower_(lower), upper_(upper)
{
  std::size_t nodes = 1;
  view_.lower = lower;
  for (std::size_t d = 0; d < Dim; ++d) {
    view_.step[d] = static_cast<std::ptrdiff_t>(nodes);
    nodes *= static_cast<std::size_t>(upper[d] - lower[d] + 1);
  }
  size_ = (nodes + kVectorOfNodes - 1) / kVectorOfNodes * kVectorOfNodes;
  numbers_.assign(size_ * (1 + 3 * Dim), 0.0);
  double* list = numbers_.data();
  const auto next = [&] { return std::exchange(list, list + size_); };
  view_.mass = next();
  for (auto* lists : {&view_.velocity, &view_.pull, &view_.brought}) std::ranges::generate(*lists, next);
}

template <int Dim> void GridNodes<Dim>::share(const Site<Dim>& lower, const Site<Dim>& upper)
{
  int rank = 0, ranks = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &ranks);
  if (ranks == 1) return;
  shared_.clear();
  owned_.assign(size_, 1);
  const std::vector<NodeEnds<Dim>> all = gather_all(comm_, std::vector{NodeEnds<Dim>{lower, upper}});
  for (int other = 0; other < ranks; ++other) {
    NodeEnds<Dim> both{lower, upper};
    bool any = other != rank;
    std::size_t lines = 1;
    for (std::size_t d = 0; d < Dim; ++d) {
      both.lower[d] = std::max(lower[d], all[static_cast<std::size_t>(other)].lower[d]);
      both.upper[d] = std::min(upper[d], all[static_cast<std::size_t>(other)].upper[d]);
      any = any && both.lower[d] <= both.upper[d];
      if (any && d > 0) lines *= static_cast<std::size_t>(both.upper[d] - both.lower[d] + 1);
    }
    if (!any) continue;
    Shared shared{other, both.lower, both.upper, {}, {}, 0};
    for (std::size_t line = 0; line < lines; ++line) {
      Site<Dim> from = both.lower;
      std::size_t rest = line;
      for (std::size_t d = 1; d < Dim; ++d) {
        const auto count = static_cast<std::size_t>(both.upper[d] - both.lower[d] + 1);
        from[d] += static_cast<Index>(rest % count);
        rest /= count;
      }
      shared.first.push_back(number(from));
      shared.length.push_back(static_cast<std::size_t>(both.upper[0] - both.lower[0] + 1));
      shared.nodes += shared.length.back();
      if (other < rank)
        std::fill_n(owned_.begin() + static_cast<std::ptrdiff_t>(shared.first.back()), shared.length.back(),
                    std::uint8_t{0});
    }
    shared_.push_back(std::move(shared));
  }
}

template <int Dim> std::size_t GridNodes<Dim>::number(const Site<Dim>& node) const
{
  std::ptrdiff_t at = 0;
  for (std::size_t d = 0; d < Dim; ++d) at += (node[d] - lower_[d]) * view_.step[d];
  return static_cast<std::size_t>(at);
}

template <int Dim> bool GridNodes<Dim>::is_shared(const Site<Dim>& lower, const Site<Dim>& upper) const
{
  return std::ranges::any_of(shared_, [&](const Shared& shared) {
    bool any = true;
    for (std::size_t d = 0; d < Dim; ++d) any = any && lower[d] <= shared.upper[d] && upper[d] >= shared.lower[d];
    return any;
  });
}

template <int Dim> void GridNodes<Dim>::add_up(std::span<double* const> lists)
{
  if (shared_.empty()) return;
  std::vector<std::vector<double>> out(shared_.size()), in(shared_.size());
  std::vector<MPI_Request> requests(2 * shared_.size());
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    in[k].resize(shared_[k].nodes * lists.size());
    MPI_Irecv(in[k].data(), static_cast<int>(in[k].size()), MPI_DOUBLE, shared_[k].rank, kTag, comm_, &requests[2 * k]);
    for (const double* list : lists)
      for (std::size_t p = 0; p < shared_[k].first.size(); ++p)
        out[k].insert(out[k].end(), list + shared_[k].first[p], list + shared_[k].first[p] + shared_[k].length[p]);
    MPI_Isend(out[k].data(), static_cast<int>(out[k].size()), MPI_DOUBLE, shared_[k].rank, kTag, comm_,
              &requests[2 * k + 1]);
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  for (std::size_t k = 0; k < shared_.size(); ++k) {
    const double* from = in[k].data();
    for (double* list : lists)
      for (std::size_t p = 0; p < shared_[k].first.size(); ++p)
        for (std::size_t n = 0; n < shared_[k].length[p]; ++n) list[shared_[k].first[p] + n] += *from++;
  }
}

template class GridNodes<2>;
template class GridNodes<3>;
} // namespace pdx::mpm
