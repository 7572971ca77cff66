#include "pdx/solve/staged_elimination.hpp"

#include <algorithm>

namespace pdx::solve {
namespace {
constexpr std::size_t kMostBetween = 700; // components; above it the core is chosen anew
} // namespace

StagedElimination::StagedElimination(const ElementsOfLayout& elements, std::shared_ptr<LastingCore>* core,
                                     std::vector<double>& condensed)
{
  LastingCore::Change change;
  if (core) core_ = *core;
  if (core_) change = core_->go_to(elements);
  if (!change.stands || elements.free.size() > core_->inner().size() + kMostBetween) {
    core_.reset(); // before there is another
    if (core) core->reset();
    core_ = std::make_shared<LastingCore>(elements, change.changed);
    fault_ = core_->fault();
    if (!fault_.empty()) return;
    if (core) *core = core_;
  }
  inner_ = core_->inner();
  std::vector<PetscInt> sorted = inner_;
  std::ranges::sort(sorted);
  const auto place = [](std::span<const PetscInt> list, PetscInt c) {
    return static_cast<std::size_t>(std::ranges::lower_bound(list, c) - list.begin());
  };
  for (std::size_t f = 0; f < elements.free.size(); ++f) {
    if (std::ranges::binary_search(sorted, elements.free[f])) continue;
    rest_.push_back(elements.free[f]);
    rest_to_.push_back(f);
  }
  for (const PetscInt c : inner_) core_to_.push_back(place(elements.free, c));
  const std::size_t between_size = rest_.size();
  rest_.insert(rest_.end(), elements.kept.begin(), elements.kept.end());
  const std::span<const PetscInt> all(rest_);
  for (const PetscInt c : core_->border()) {
    const std::size_t early = place(all.first(between_size), c);
    border_.push_back(early < between_size && rest_[early] == c ? early
                                                                : between_size + place(all.subspan(between_size), c));
  }
  dense_ = std::make_unique<DenseElimination>(between(elements), between_size);
  if (!core) core_->forget_correction();
  if (!dense_->sound()) fault_ = "elements hang on nothing that is held or has particles";
  condensed = dense_->schur();
}

/// What is left of the rest once the core is gone.
DenseSquare StagedElimination::between(const ElementsOfLayout& elements) const
{
  const MatrixRows& k = elements.stiffness;
  std::vector<PetscInt> place(k.size(), -1);
  for (std::size_t r = 0; r < rest_.size(); ++r) place[static_cast<std::size_t>(rest_[r])] = static_cast<PetscInt>(r);
  DenseSquare matrix(rest_.size());
  for (std::size_t r = 0; r < rest_.size(); ++r)
    k.for_each(rest_[r], [&](PetscInt column, double value) {
      if (const PetscInt to = place[static_cast<std::size_t>(column)]; to >= 0)
        matrix.row(r)[static_cast<std::size_t>(to)] = value;
    });
  const std::vector<double>& correction = core_->correction();
  for (std::size_t a = 0; a < border_.size(); ++a)
    for (std::size_t b = 0; b < border_.size(); ++b)
      matrix.row(border_[a])[border_[b]] += correction[a * border_.size() + b];
  return matrix;
}

std::vector<double> StagedElimination::condense(const std::vector<double>& force)
{
  core_loaded_ = core_->loaded(pick(force, inner_));
  std::vector<double> at_border(border_.size()), rest = pick(force, rest_);
  for (std::size_t b = 0; b < border_.size(); ++b) at_border[b] = rest[border_[b]];
  at_border = core_->condensed(std::move(at_border), core_loaded_);
  for (std::size_t b = 0; b < border_.size(); ++b) rest[border_[b]] = at_border[b];
  dense_->condense(rest);
  const auto kept = rest.begin() + static_cast<std::ptrdiff_t>(dense_->eliminated());
  rest_loaded_.assign(rest.begin(), kept);
  return {kept, rest.end()};
}

std::vector<double> StagedElimination::answer(double load, std::span<const double> kept) const
{
  std::vector<double> rest, at_border;
  for (const double f : rest_loaded_) rest.push_back(load * f);
  rest.insert(rest.end(), kept.begin(), kept.end());
  dense_->answer(rest);
  for (const std::size_t b : border_) at_border.push_back(rest[b]);
  const std::vector<double> core = core_->answer(at_border);
  std::vector<double> free(core_to_.size() + rest_to_.size());
  for (std::size_t k = 0; k < core_to_.size(); ++k) free[core_to_[k]] = core[k] + load * core_loaded_[k];
  for (std::size_t k = 0; k < rest_to_.size(); ++k) free[rest_to_[k]] = rest[k];
  return free;
}
} // namespace pdx::solve
