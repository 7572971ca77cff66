#include "pdx/solve/lasting_core.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::solve {
namespace {
constexpr std::size_t kMostAhead = 400; // components around what changed last; as many more take as long as a solve
constexpr double kSame = 1e-13;         // of the largest entry: sums of elements in another order

enum Role : std::uint8_t { prescribed, free_one, kept_one };
std::vector<std::uint8_t> roles(const ElementsOfLayout& in, std::size_t size)
{
  std::vector<std::uint8_t> role(size, prescribed);
  for (const PetscInt c : in.free) role[static_cast<std::size_t>(c)] = free_one;
  for (const PetscInt c : in.kept) role[static_cast<std::size_t>(c)] = kept_one;
  return role;
}

/// Number in `next` of each row that stays, by its number before; -1 of the others.
std::vector<PetscInt> renumbered(std::span<const NamedRow> before, std::span<const NamedRow> next)
{
  PetscInt last = -1;
  for (const NamedRow& row : before) last = std::max(last, row.row);
  std::vector<PetscInt> to(static_cast<std::size_t>(last + 1), -1);
  auto at = next.begin();
  for (const NamedRow& row : before) {
    while (at != next.end() && at->name < row.name) ++at;
    if (at != next.end() && at->name == row.name) to[static_cast<std::size_t>(row.row)] = at->row;
  }
  return to;
}
} // namespace

LastingCore::LastingCore(const ElementsOfLayout& in, std::span<const PetscInt> changed) : dim_(in.dim), rows_(in.rows)
{
  const MatrixRows& k = in.stiffness;
  choose(k, in, changed);
  if (!rows_.empty()) remember(k);
  if (inner_.empty()) return;
  factor_ = std::make_unique<InnerFactor>(k.matrix(), inner_, border_, correction_);
  fault_ = factor_->fault();
  if (!fault_.empty()) return;
  std::vector<PetscInt> place(k.size(), -1);
  for (std::size_t b = 0; b < border_.size(); ++b)
    place[static_cast<std::size_t>(border_[b])] = static_cast<PetscInt>(b);
  for (std::size_t b = 0; b < border_.size(); ++b)
    k.for_each(border_[b], [&](PetscInt column, double value) {
      if (const PetscInt to = place[static_cast<std::size_t>(column)]; to >= 0)
        correction_[b * border_.size() + static_cast<std::size_t>(to)] -= value;
    });
}

/// All that is free, but for some layers around what changed.
void LastingCore::choose(const MatrixRows& k, const ElementsOfLayout& in, std::span<const PetscInt> changed)
{
  const std::vector<std::uint8_t> role = roles(in, k.size());
  std::vector<std::uint8_t> seen(k.size(), 0), ahead(k.size(), 0);
  std::vector<PetscInt> layer(changed.begin(), changed.end());
  for (const PetscInt c : layer) seen[static_cast<std::size_t>(c)] = 1;
  for (std::size_t count = 0; !layer.empty();) {
    count += static_cast<std::size_t>(
        std::ranges::count_if(layer, [&](PetscInt c) { return role[static_cast<std::size_t>(c)] == free_one; }));
    if (count > kMostAhead) break;
    std::vector<PetscInt> next;
    for (const PetscInt c : layer) {
      ahead[static_cast<std::size_t>(c)] = 1;
      k.for_each(c, [&](PetscInt other, double) {
        const auto o = static_cast<std::size_t>(other);
        if (seen[o] || role[o] == prescribed) return;
        seen[o] = 1;
        next.push_back(other);
      });
    }
    layer = std::move(next);
  }
  std::vector<std::uint8_t> around(k.size(), 0);
  for (const PetscInt c : in.free)
    if (!ahead[static_cast<std::size_t>(c)]) inner_.push_back(c);
  for (const PetscInt c : inner_) around[static_cast<std::size_t>(c)] = 1;
  for (const PetscInt c : inner_)
    k.for_each(c, [&](PetscInt other, double) {
      const auto o = static_cast<std::size_t>(other);
      if (around[o] || role[o] == prescribed) return;
      around[o] = 2;
      border_.push_back(other);
    });
  std::ranges::sort(border_);
}

void LastingCore::remember(const MatrixRows& k)
{
  std::vector<std::uint8_t> mine(k.size(), 0);
  for (const auto* part : {&inner_, &border_})
    for (const PetscInt c : *part) mine[static_cast<std::size_t>(c)] = 1;
  offsets_.push_back(0);
  for (const PetscInt c : inner_) {
    k.for_each(c, [&](PetscInt column, double value) {
      if (!mine[static_cast<std::size_t>(column)]) return;
      columns_.push_back(column);
      values_.push_back(value);
      scale_ = std::max(scale_, std::abs(value));
    });
    offsets_.push_back(columns_.size());
  }
}

LastingCore::Change LastingCore::go_to(const ElementsOfLayout& next)
{
  Change change;
  if (rows_.empty() || next.rows.empty() || next.dim != dim_) return change;
  const MatrixRows& k = next.stiffness;
  const std::vector<PetscInt> row_to = renumbered(rows_, next.rows);
  const auto to = [&](PetscInt c) {
    const PetscInt row = row_to[static_cast<std::size_t>(c / dim_)];
    return row < 0 ? -1 : row * dim_ + c % dim_;
  };
  const std::vector<std::uint8_t> role = roles(next, k.size());
  std::vector<double> row(k.size(), 0.0); // as it was, less as it is
  const double same = kSame * scale_;
  bool lost = false;
  for (std::size_t q = 0; q < inner_.size(); ++q) {
    const PetscInt now = to(inner_[q]);
    if (now < 0) {
      lost = true;
      continue;
    }
    bool differs = role[static_cast<std::size_t>(now)] != free_one;
    for (std::size_t e = offsets_[q]; e < offsets_[q + 1]; ++e)
      if (const PetscInt column = to(columns_[e]); column >= 0)
        row[static_cast<std::size_t>(column)] = values_[e];
      else
        differs = true;
    k.for_each(now, [&](PetscInt column, double value) {
      const auto c = static_cast<std::size_t>(column);
      if (role[c] == prescribed) return;
      differs = differs || std::abs(value - row[c]) > same;
      row[c] = 0.0;
    });
    for (std::size_t e = offsets_[q]; e < offsets_[q + 1]; ++e)
      if (const PetscInt column = to(columns_[e]); column >= 0) {
        double& left = row[static_cast<std::size_t>(column)];
        differs = differs || std::abs(left) > same;
        left = 0.0;
      }
    if (differs) change.changed.push_back(now);
  }
  change.stands = !lost && change.changed.empty();
  if (!change.stands) return change;
  for (auto* list : {&inner_, &border_, &columns_})
    for (PetscInt& c : *list) c = to(c);
  rows_ = next.rows;
  return change;
}

const std::vector<double>& LastingCore::loaded(const std::vector<double>& force)
{
  if (loaded_.empty() || force != force_) {
    const bool any = std::ranges::any_of(force, [](double f) { return f != 0.0; });
    loaded_ = any ? factor_->solve(force) : force;
    force_ = force;
  }
  return loaded_;
}
} // namespace pdx::solve
