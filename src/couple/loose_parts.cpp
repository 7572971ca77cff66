#include "pdx/couple/loose_parts.hpp"

#include "pdx/base/events.hpp"
#include "pdx/base/gather.hpp"
#include "pdx/base/joined.hpp"
#include "pdx/base/symmetric.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>

namespace pdx::couple {
namespace {
constexpr double kNoResistance = 1e-10; // of the largest of a part

Site<2> stepped(Site<2> site, const Site<2>& step)
{
  site[0] += step[0];
  site[1] += step[1];
  return site;
}

struct Pair {
  PetscInt a, b;
};

double least_resistance(const SymmetricModes& modes) { return kNoResistance * std::max(1.0, modes.values[2]); }

/// Modes that nothing resists, in words.
std::string free_motions(const SymmetricModes& modes)
{
  Eigen::Matrix3d free = Eigen::Matrix3d::Zero(); // projector
  int count = 0;
  for (; count < 3 && modes.values[count] <= least_resistance(modes); ++count)
    free += modes.vectors.col(count) * modes.vectors.col(count).transpose();
  std::string words;
  const auto add = [&](const char* word) { words += (words.empty() ? "" : " and ") + std::string(word); };
  for (Eigen::Index d = 0; d < 2; ++d)
    if (free(d, d) > 1.0 - 1e-6) {
      add(d == 0 ? "slide along x" : "slide along y");
      --count;
    }
  if (count > 0) add("rotate");
  return words;
}

/// Numbers sets of rows that are known by pairs, everybody the same pairs.
class Names {
public:
  explicit Names(const std::vector<Pair>& pairs)
  {
    for (const Pair& pair : pairs) joined_.join(number(pair.a), number(pair.b));
  }
  PetscInt of(PetscInt row)
  {
    const auto at = numbers_.find(row);
    return at == numbers_.end() ? row : rows_[joined_.root(at->second)];
  }

private:
  std::size_t number(PetscInt row)
  {
    const auto [at, fresh] = numbers_.try_emplace(row, rows_.size());
    if (fresh) {
      rows_.push_back(row);
      (void)joined_.add();
    }
    return at->second;
  }
  std::map<PetscInt, std::size_t> numbers_;
  std::vector<PetscInt> rows_;
  Joined joined_;
};
} // namespace

/// Global rows that hold together, as far as this rank sees.
class LooseParts::Ties {
public:
  explicit Ties(const field::Rows& rows)
      : rows_(rows), joined_(static_cast<std::size_t>(rows.owned())),
        tied_(static_cast<std::size_t>(rows.owned()), false)
  {}
  void join(PetscInt a, PetscInt b)
  {
    if (a == b) return;
    const std::size_t i = number(a), j = number(b);
    tied_[i] = tied_[j] = true;
    joined_.join(i, j);
  }
  /// Per owned row: a row that names its part, -1 where it is joined to nothing. Collective.
  std::vector<PetscInt> labels()
  {
    std::vector<Pair> outer, inner;
    for (const auto& [row, k] : foreign_) outer.push_back({row, name(k)});
    outer = gather_all(rows_.comm, outer);
    for (const Pair& pair : outer)
      if (rows_.owns(pair.a)) {
        inner.push_back({pair.a, name(number(pair.a))});
        tied_[number(pair.a)] = true;
      }
    inner = gather_all(rows_.comm, inner);
    outer.insert(outer.end(), inner.begin(), inner.end());
    Names names(outer);
    std::vector<PetscInt> labels(static_cast<std::size_t>(rows_.owned()), -1);
    for (std::size_t k = 0; k < labels.size(); ++k)
      if (tied_[k]) labels[k] = names.of(name(k));
    return labels;
  }

private:
  std::size_t number(PetscInt row)
  {
    if (rows_.owns(row)) return static_cast<std::size_t>(row - rows_.first);
    const auto [at, fresh] = foreign_.try_emplace(row, 0);
    if (fresh) {
      at->second = joined_.add();
      tied_.push_back(true);
      others_.push_back(row);
    }
    return at->second;
  }
  /// The global row of a set's root.
  PetscInt name(std::size_t k)
  {
    const std::size_t root = joined_.root(k), owned = static_cast<std::size_t>(rows_.owned());
    return root < owned ? rows_.first + static_cast<PetscInt>(root) : others_[root - owned];
  }

  const field::Rows& rows_;
  Joined joined_;
  std::vector<bool> tied_;
  std::unordered_map<PetscInt, std::size_t> foreign_;
  std::vector<PetscInt> others_; // rows of other ranks, in order of numbers
};

LooseParts::LooseParts(const JoinedModels& models, const field::System& system) : models_(models), system_(system)
{
  for (const auto& part : models_.parts) foreign_.emplace_back(*part);
}

LooseParts::~LooseParts() = default;

void LooseParts::tie_elements(Ties& ties) const
{
  const auto row = [&](Index cell, std::size_t a) {
    return models_.node_rows[static_cast<std::size_t>(models_.mesh.cell(cell)[a])];
  };
  for (const mesh::Use use : {mesh::Use::plain, mesh::Use::points})
    for (const Index c : models_.mesh.cells(use))
      for (std::size_t a = 1; a < 4; ++a) ties.join(row(c, 0), row(c, a));
  if (!models_.sets) return;
  for (const xfem::CutElement& cut : models_.sets->cells())
    for (const xfem::Side side : {xfem::Side::minus, xfem::Side::plus}) {
      if (cut.element.cell.points(side).empty()) continue;
      const auto corner = [&](std::size_t a) {
        const bool far = cut.element.enriched[a] && cut.element.factor(a, side) != 0.0;
        return far ? cut.sets[a] : row(cut.cell, a);
      };
      for (std::size_t a = 1; a < 4; ++a) ties.join(corner(0), corner(a));
    }
}

/// Bonds of a patch. Not thoroughly: of a particle whose bonds are all there, two of them only; what is in one part
/// then, is in one part.
void LooseParts::tie_particles(Ties& ties, const pd::LatticePart<2>& part, std::size_t number, bool thoroughly) const
{
  const std::vector<pd::Arm<2>>& half = part.stencil().half;
  const auto near = [](const pd::Arm<2>& arm) { return std::abs(arm.step[0]) + std::abs(arm.step[1]) == 1; };
  for (Index k = 0; k < static_cast<Index>(part.sites().size()); ++k) {
    const auto words = part.words_of(k);
    const bool full = std::popcount(words[0]) + std::popcount(words[1]) == static_cast<int>(half.size());
    const Site<2> site = part.site(part.sites()[static_cast<std::size_t>(k)]);
    const PetscInt row = system_.rows.first + part.first_row() + k;
    for (std::size_t h = 0; h < half.size(); ++h) {
      if (!(words[h / 64] >> h % 64 & 1u) || (full && !thoroughly && !near(half[h]))) continue;
      const Site<2> other = stepped(site, half[h].step);
      const Index local = part.row(other);
      if (local >= 0 && local < system_.rows.owned())
        ties.join(row, system_.rows.first + local);
      else
        ties.join(row, foreign_[number].row(part.number(other)));
    }
  }
}

/// @param ties those by elements
void LooseParts::tie(Ties& ties, bool thoroughly) const
{
  for (std::size_t p = 0; p < models_.parts.size(); ++p) tie_particles(ties, *models_.parts[p], p, thoroughly);
  if (!models_.carried) return;
  std::vector<std::array<Index, 2>> pairs;
  models_.carried->add_joints(pairs);
  for (const auto& [a, b] : pairs) ties.join(system_.halo->global(a), system_.halo->global(b));
}

std::optional<LoosePart> LooseParts::find(Index debris) const
{
  static Event event("support_parts");
  Timed timed(event);
  if (!by_elements_) {
    by_elements_ = std::make_unique<Ties>(system_.rows);
    tie_elements(*by_elements_);
  }
  for (const bool thoroughly : {false, true}) {
    Ties ties(*by_elements_);
    tie(ties, thoroughly);
    const auto loose = judge(ties.labels(), debris);
    if (!loose || thoroughly) return loose;
  }
  return std::nullopt;
}

/// Sums over the rows of a part.
struct LooseParts::Part {
  PetscInt label = -1;
  double lower[2] = {std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  double upper[2] = {std::numeric_limits<double>::lowest(), std::numeric_limits<double>::lowest()};
  std::int64_t nodes = 0, particles = 0;
  bool loaded = false;

  void operator+=(const Part& other)
  {
    label = other.label;
    for (std::size_t d = 0; d < 2; ++d) {
      lower[d] = std::min(lower[d], other.lower[d]);
      upper[d] = std::max(upper[d], other.upper[d]);
    }
    nodes += other.nodes;
    particles += other.particles;
    loaded = loaded || other.loaded;
  }
  Vector<2> centre() const { return {0.5 * (lower[0] + upper[0]), 0.5 * (lower[1] + upper[1])}; }
  double size() const { return 0.5 * std::hypot(upper[0] - lower[0], upper[1] - lower[1]); }
  bool before(const Part& other) const // the larger, then the lower left one
  {
    return std::tuple(-nodes - particles, lower[0], lower[1]) <
           std::tuple(-other.nodes - other.particles, other.lower[0], other.lower[1]);
  }
};

std::optional<LoosePart> LooseParts::judge(const std::vector<PetscInt>& labels, Index debris) const
{
  const field::Rows& rows = system_.rows;
  const auto& x = system_.coordinates;
  std::map<PetscInt, Part> parts;
  Part* latest = nullptr;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (labels[k] < 0) continue;
    const bool particle = static_cast<Index>(k) >= rows.first_particle();
    const bool loaded = system_.load[2 * k] != 0.0 || system_.load[2 * k + 1] != 0.0;
    const double at[2] = {x[2 * k], x[2 * k + 1]};
    if (!latest || latest->label != labels[k]) latest = &parts[labels[k]];
    *latest += Part{labels[k], {at[0], at[1]}, {at[0], at[1]}, !particle, particle, loaded};
  }
  std::vector<Part> mine;
  for (const auto& [label, of] : parts) mine.push_back(of);
  parts.clear();
  for (const Part& of : gather_all(rows.comm, mine)) parts[of.label] += of;

  // How strongly the held components of a part resist each rigid motion: translations along x and y, rotation.
  struct Resistance {
    PetscInt label;
    double values[9];
  };
  std::map<PetscInt, Eigen::Matrix3d> resistances;
  const auto resist = [&](Index owned_row, const Vector<2>& along) {
    const auto row = static_cast<std::size_t>(owned_row);
    if (labels[row] < 0) return;
    const Part& part = parts.at(labels[row]);
    const Vector<2> r = (Vector<2>(x[2 * row], x[2 * row + 1]) - part.centre()) / part.size();
    const Eigen::Vector3d motion(along[0], along[1], r[0] * along[1] - r[1] * along[0]);
    resistances.try_emplace(labels[row], Eigen::Matrix3d::Zero()).first->second += motion * motion.transpose();
  };
  for (const Index component : system_.prescribed.components)
    resist(component / 2, component % 2 ? Vector<2>(0.0, 1.0) : Vector<2>(1.0, 0.0));
  for (const field::Roller& roller : system_.rollers) resist(roller.row, roller.along.head<2>());
  std::vector<field::Resisting> supported;
  for (const field::Support* support : system_.supports) support->resisting(supported);
  for (const field::Resisting& by : supported) resist(by.row, by.along.head<2>());
  std::vector<Resistance> summands;
  for (const auto& [label, matrix] : resistances) {
    Resistance& summand = summands.emplace_back(Resistance{label, {}});
    std::copy(matrix.data(), matrix.data() + 9, summand.values);
  }
  resistances.clear();
  for (const Resistance& summand : gather_all(rows.comm, summands))
    resistances.try_emplace(summand.label, Eigen::Matrix3d::Zero()).first->second +=
        Eigen::Map<const Eigen::Matrix3d>(summand.values);

  const Part* largest = nullptr;
  LoosePart loose;
  for (const auto& [label, part] : parts) {
    if (part.nodes == 0 && part.particles <= debris && !part.loaded) continue;
    const auto held = resistances.find(label);
    const Eigen::Matrix3d resistance = held == resistances.end() ? Eigen::Matrix3d::Zero() : held->second;
    const SymmetricModes modes = symmetric_modes(resistance);
    if (modes.values[0] > least_resistance(modes)) continue;
    ++loose.others;
    if (largest && !part.before(*largest)) continue;
    largest = &part;
    loose.motion = free_motions(modes);
  }
  if (!largest) return std::nullopt;
  --loose.others;
  loose.box = {Vector<2>(largest->lower[0], largest->lower[1]), Vector<2>(largest->upper[0], largest->upper[1])};
  loose.nodes = largest->nodes;
  loose.particles = largest->particles;
  loose.whole = parts.size() == 1;
  return loose;
}
} // namespace pdx::couple
