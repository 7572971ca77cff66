#include "pdx/pd/strip_part.hpp"

#include <algorithm>
#include <limits>
#include <map>

// How a StripPart is laid out: all that is done once, and what follows from the bonds.
namespace pdx::pd {
namespace {
constexpr Index kTileColumns = 16;
} // namespace

template <int Dim>
StripPart<Dim>::StripPart(LatticePart<Dim>& part, Kinematics kinematics, Processor processor)
    : part_(part), kinematics_(kinematics), processor_(processor), lanes_(lanes_of(processor)),
      stencil_reach_(part.stencil().reach)
{
  lay_out();
  lay_arms();
  lay_tiles();
  lay_pieces();
  lay_ends();
  lay_factors();
  take_over_words();
}

template <int Dim> void StripPart<Dim>::lay_out()
{
  extent_ = part_.extent();
  const Index padded = extent_[0];
  extent_[0] = 0;
  for (const Run& run : part_.particle_runs())
    extent_[0] = std::max(extent_[0], static_cast<Index>(run.at % padded) + run.length);
  for (const std::ptrdiff_t at : part_.halo_at())
    extent_[0] = std::max(extent_[0], static_cast<Index>(at % padded) + 1);
  columns_ = std::max((extent_[0] + lanes_ - 1) / lanes_, stencil_reach_);
  pitch_ = columns_ + 2 * stencil_reach_;
}

template <int Dim> void StripPart<Dim>::lay_arms()
{
  const std::span<const HalfArm<Dim>> arms = part_.view({}).arms;
  std::ptrdiff_t furthest = 0, lines = 1;
  for (std::size_t d = 1; d < Dim; ++d) lines *= extent_[d];
  for (std::size_t h = 0; h < arms.size(); ++h) {
    const Site<Dim>& step = part_.stencil().half[h].step;
    std::ptrdiff_t line = 0;
    for (std::size_t d = Dim - 1; d > 0; --d) line = line * extent_[d] + step[d];
    const std::ptrdiff_t vectors = line * pitch_ + step[0];
    furthest = std::max(furthest, vectors);
    const double length = arms[h].length;
    arms_.push_back({vectors * StripView<Dim>::kParts * lanes_, arms[h].xi, 1.0 / (length * length),
                     arms[h].kappa / length, length, std::uint64_t{1} << h % 64});
  }
  vectors_ = part_.sites().empty() ? 0 : lines * pitch_ + furthest;
  blocks_.resize(vectors_ * StripView<Dim>::kParts * lanes_);
  ends_.resize(vectors_ * lanes_);
  for (std::size_t p = 0; 64 * p < arms_.size(); ++p) words_[p].resize(vectors_ * lanes_);
  view_ = {blocks_.data(), {words_[0].data(), words_[1].data()}, nullptr, nullptr, ends_.data(), arms_};
}

template <int Dim> typename StripPart<Dim>::Spot StripPart<Dim>::spot(std::ptrdiff_t window) const
{
  const std::ptrdiff_t padded = part_.extent()[0], line = window / padded;
  const auto x = static_cast<int>(window % padded);
  const int column = x % columns_;
  return {line * pitch_ + stencil_reach_ + column, line, x / columns_, column};
}

template <int Dim> int StripPart<Dim>::tile_of(const Spot& spot) const
{
  const auto column = std::upper_bound(column_ends_.begin(), column_ends_.end(), spot.column) - column_ends_.begin();
  const std::ptrdiff_t y = spot.line % extent_[1], z = spot.line / extent_[1];
  const std::ptrdiff_t row = y / span_[1] + (Dim == 3 ? z / span_[Dim - 1] * tiles_[1] : 0);
  return static_cast<int>(row * tiles_[0] + column);
}

template <int Dim> void StripPart<Dim>::lay_tiles()
{
  slab_.resize(1);
  if (!vectors_) return;
  tiles_[0] = std::max(1, (columns_ + kTileColumns / 2) / kTileColumns);
  for (Index t = 1; t <= tiles_[0]; ++t) column_ends_.push_back(t * columns_ / tiles_[0]);
  std::size_t total = static_cast<std::size_t>(tiles_[0]);
  for (std::size_t d = 1; d < Dim; ++d) {
    span_[d] = Dim == 2 ? 16 : 4;
    tiles_[d] = (extent_[d] + span_[d] - 1) / span_[d];
    total *= static_cast<std::size_t>(tiles_[d]);
  }
  slab_.resize(static_cast<std::size_t>(slabs()) + 1);
  tasks_.resize(total);
  for (StripTask& task : tasks_) task.series = Series::fifth;
  busy_.resize(total);
}

template <int Dim> void StripPart<Dim>::lay_pieces()
{
  for (const Run& run : part_.particle_runs())
    for (Index k = 0; k < run.length;) {
      const Spot first = spot(run.at + k);
      const Index end = *std::upper_bound(column_ends_.begin(), column_ends_.end(), first.column);
      const Index length = std::min(run.length - k, end - first.column);
      pieces_.push_back({block(first), run.row + k, length, tile_of(first), false});
      for (Index c = 0; c < length; ++c) ends_.data()[(first.vector + c) * lanes_ + first.lane] = 0.5;
      k += length;
    }
  const auto per_slab = slabs() ? static_cast<std::ptrdiff_t>(tasks_.size()) / slabs() : 1;
  for (std::size_t slab = 0; slab < slab_.size(); ++slab) // pieces are in the order of lines
    slab_[slab].pieces = static_cast<std::size_t>(
        std::partition_point(
            pieces_.begin(), pieces_.end(),
            [&](const Piece& piece) { return piece.tile < static_cast<std::ptrdiff_t>(slab) * per_slab; }) -
        pieces_.begin());
  for (const std::ptrdiff_t at : part_.halo_at()) halo_.push_back({block(spot(at)), tile_of(spot(at))});
}

/// `ends` are read at neighbours too, so that their ghost columns are filled here once.
template <int Dim> void StripPart<Dim>::lay_ends()
{
  const std::ptrdiff_t lines = pitch_ && vectors_ ? (vectors_ - 1) / pitch_ : 0;
  for (std::ptrdiff_t line = 0; line < lines; ++line) {
    double* first = ends_.data() + (line * pitch_ + stencil_reach_) * lanes_;
    for (std::ptrdiff_t c = 0; c < stencil_reach_; ++c)
      for (std::ptrdiff_t l = 0; l + 1 < lanes_; ++l) {
        first[(columns_ + c) * lanes_ + l] = first[c * lanes_ + l + 1];
        first[(c - stencil_reach_) * lanes_ + l + 1] = first[(columns_ - stencil_reach_ + c) * lanes_ + l];
      }
  }
}

/// Vectors whose lanes are of the same classes are of one class.
template <int Dim> void StripPart<Dim>::lay_factors()
{
  const BondView<Dim> from = part_.view({});
  if (!from.classes || !vectors_) return;
  std::vector<std::uint16_t> lanes(static_cast<std::size_t>(vectors_ * lanes_), 0);
  std::ptrdiff_t sites = part_.extent()[0];
  for (std::size_t d = 1; d < Dim; ++d) sites *= extent_[d];
  for (std::ptrdiff_t at = 0; at < sites; ++at) {
    if (at % part_.extent()[0] >= extent_[0] || !from.classes[at]) continue;
    const Spot s = spot(at);
    lanes[static_cast<std::size_t>(s.vector * lanes_ + s.lane)] = from.classes[at];
    tasks_[static_cast<std::size_t>(tile_of(s))].scaled = true;
  }
  const auto width = static_cast<std::size_t>(lanes_);
  std::map<std::vector<std::uint16_t>, std::uint16_t> known{{std::vector<std::uint16_t>(width, 0), 0}};
  classes_.resize(static_cast<std::size_t>(vectors_));
  for (std::size_t v = 0; v < classes_.size(); ++v) {
    const auto first = lanes.begin() + static_cast<std::ptrdiff_t>(v * width);
    if (std::all_of(first, first + lanes_, [](std::uint16_t of) { return of == 0; })) continue; // of class 0
    if (known.size() > std::numeric_limits<std::uint16_t>::max())
      throw std::logic_error("more classes of corrected bonds in lane strips than 65536");
    classes_[v] = known.try_emplace({first, first + lanes_}, static_cast<std::uint16_t>(known.size())).first->second;
  }
  factors_.resize(static_cast<std::ptrdiff_t>(known.size() * arms_.size() * width));
  for (const auto& [of_lanes, number] : known)
    for (std::size_t h = 0; h < arms_.size(); ++h)
      for (std::size_t l = 0; l < width; ++l)
        factors_.data()[(number * arms_.size() + h) * width + l] = from.factors[of_lanes[l] * arms_.size() + h];
  view_.classes = classes_.data();
  view_.factors = factors_.data();
}

template <int Dim> void StripPart<Dim>::take_over_words()
{
  const BondView<Dim> from = part_.view({});
  for (std::size_t p = 0; part_.protects_any() && 64 * p < arms_.size(); ++p) breakable_[p].resize(vectors_ * lanes_);
  std::ptrdiff_t sites = vectors_ ? part_.extent()[0] : 0;
  for (std::size_t d = 1; d < Dim; ++d) sites *= extent_[d];
  std::vector<std::uint8_t> owned(static_cast<std::size_t>(sites), 0);
  for (const Run& run : part_.particle_runs()) std::fill_n(owned.begin() + run.at, run.length, std::uint8_t{1});
  for (std::ptrdiff_t at = 0; at < sites; ++at) {
    if (at % part_.extent()[0] >= extent_[0]) continue;
    const Spot s = spot(at);
    for (std::size_t p = 0; 64 * p < arms_.size(); ++p) {
      std::uint64_t word = from.words[p][at];
      for (std::size_t h = 64 * p;
           word && !owned[static_cast<std::size_t>(at)] && h < std::min(64 * p + 64, arms_.size()); ++h)
        if (const std::ptrdiff_t j = at + from.arms[h].jump; j >= sites || !owned[static_cast<std::size_t>(j)])
          word &= ~arms_[h].bit;
      words_[p].data()[s.vector * lanes_ + s.lane] = word;
      if (!part_.protects_any()) continue;
      for (std::size_t h = 64 * p; h < std::min(64 * p + 64, arms_.size()); ++h)
        if ((word & arms_[h].bit) && part_.protects(at, h)) word &= ~arms_[h].bit;
      breakable_[p].data()[s.vector * lanes_ + s.lane] = word;
    }
  }
  shrink_boxes();
}

template <int Dim> void StripPart<Dim>::move_rows(Index by)
{
  computed_ = skipped_ = 0;
  for (Piece& piece : pieces_) piece.row += by;
}

/// The box of each tile: the smallest that has all bonds that start in the tile.
template <int Dim> void StripPart<Dim>::shrink_boxes()
{
  struct Bounds {
    Site<3> lower{1 << 30, 1 << 30, 1 << 30}, upper{-1, -1, -1}; // column, y, z
  };
  std::vector<Bounds> bounds(tasks_.size());
  const std::ptrdiff_t lines = vectors_ ? extent_[1] * (Dim == 3 ? extent_[Dim - 1] : 1) : 0;
  for (std::ptrdiff_t line = 0; line < lines; ++line)
    for (int c = 0; c < columns_; ++c) {
      const Spot s{line * pitch_ + stencil_reach_ + c, line, 0, c};
      std::uint64_t any = 0;
      for (std::size_t p = 0; 64 * p < arms_.size(); ++p)
        for (int l = 0; l < lanes_; ++l) any |= words_[p].data()[s.vector * lanes_ + l];
      if (!any) continue;
      Bounds& b = bounds[static_cast<std::size_t>(tile_of(s))];
      const Site<3> site{c, static_cast<Index>(line % extent_[1]), static_cast<Index>(line / extent_[1])};
      for (std::size_t d = 0; d < 3; ++d) {
        b.lower[d] = std::min(b.lower[d], site[d]);
        b.upper[d] = std::max(b.upper[d], site[d]);
      }
    }
  for (std::size_t t = 0; t < tasks_.size(); ++t) {
    const Bounds& b = bounds[t];
    tasks_[t].box = {};
    tasks_[t].lowest = tasks_[t].highest = 0.0;
    if (b.upper[0] < 0) continue;
    const std::ptrdiff_t plane = pitch_ * extent_[1];
    tasks_[t].box = {b.lower[2] * plane + b.lower[1] * pitch_ + stencil_reach_ + b.lower[0],
                     b.upper[0] - b.lower[0] + 1,
                     b.upper[1] - b.lower[1] + 1,
                     b.upper[2] - b.lower[2] + 1,
                     pitch_,
                     plane};
  }
}

/// Of each tile the least critical stretch over that of the patch, of all bonds that start there; infinity: none
/// breaks.
template <int Dim> void StripPart<Dim>::watch_tiles()
{
  thresholds_.assign(tasks_.size(), std::numeric_limits<double>::infinity());
  std::ptrdiff_t sites = vectors_ ? part_.extent()[0] : 0;
  for (std::size_t d = 1; d < Dim; ++d) sites *= extent_[d];
  for (std::ptrdiff_t at = 0; at < sites; ++at) {
    if (at % part_.extent()[0] >= extent_[0]) continue;
    const Spot s = spot(at);
    double& least = thresholds_[static_cast<std::size_t>(tile_of(s))];
    for (std::size_t h = 0; h < arms_.size(); ++h) // only bonds of this rank: others may lead out of the window
      if (words_[h / 64].data()[s.vector * lanes_ + s.lane] & arms_[h].bit)
        least = std::min(least, part_.stretch_factor(at, h));
  }
}

/// The tiles given and all within reach of them; in x round the ends of the strips, which touch each other.
template <int Dim> std::vector<std::uint8_t> StripPart<Dim>::around(const std::vector<std::uint8_t>& tiles) const
{
  if (tiles.empty()) return {}; // a rank without particles
  std::vector<std::uint8_t> now = tiles, next;
  std::ptrdiff_t stride = 1;
  for (std::size_t d = 0; d < Dim; ++d) {
    const Index count = tiles_[d], rings = d == 0 ? 1 : (stencil_reach_ + span_[d] - 1) / span_[d];
    next = now;
    for (std::ptrdiff_t t = 0; t < static_cast<std::ptrdiff_t>(now.size()); ++t) {
      if (!now[static_cast<std::size_t>(t)]) continue;
      const auto at = static_cast<Index>(t / stride % count);
      for (Index shift = -rings; shift <= rings; ++shift) {
        Index to = at + shift;
        if (d == 0) to = (to + count) % count;
        if (to >= 0 && to < count) next[static_cast<std::size_t>(t + (to - at) * stride)] = 1;
      }
    }
    now.swap(next);
    stride *= count;
  }
  return now;
}

#define PDX_INSTANTIATE(Dim)                                                                                           \
  template StripPart<Dim>::StripPart(LatticePart<Dim>&, Kinematics, Processor);                                        \
  template void StripPart<Dim>::take_over_words();                                                                     \
  template void StripPart<Dim>::move_rows(Index);                                                                      \
  template void StripPart<Dim>::watch_tiles();                                                                         \
  template std::vector<std::uint8_t> StripPart<Dim>::around(const std::vector<std::uint8_t>&) const
PDX_INSTANTIATE(2);
PDX_INSTANTIATE(3);
#undef PDX_INSTANTIATE
} // namespace pdx::pd
