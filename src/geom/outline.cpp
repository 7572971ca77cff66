#include "pdx/geom/outline.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::geom {
namespace {
constexpr std::size_t kMostRows = 4096; // more save nothing: places are looked for one by one
} // namespace

Outline::Outline(std::vector<Edge> edges) : edges_(std::move(edges))
{
  if (edges_.empty()) return;
  box_ = {edges_[0][0], edges_[0][0]};
  for (const Edge& edge : edges_)
    for (const Vector<2>& end : edge) {
      box_.lower = box_.lower.cwiseMin(end).eval();
      box_.upper = box_.upper.cwiseMax(end).eval();
    }
  const std::size_t rows = std::clamp<std::size_t>(edges_.size() / 2, 1, kMostRows);
  const double height = box_.size()[1];
  rows_per_length_ = height > 0.0 ? static_cast<double>(rows) / height : 0.0;
  in_row_.resize(rows);
  for (std::size_t k = 0; k < edges_.size(); ++k) {
    const auto [low, high] = std::minmax(edges_[k][0][1], edges_[k][1][1]);
    for (std::size_t row = row_of(low); row <= row_of(high); ++row) in_row_[row].push_back(static_cast<Index>(k));
  }
}

std::vector<Outline::Edge> Outline::edges_of(const Box<2>& box)
{
  const Vector<2> a = box.lower, c = box.upper, b(c[0], a[1]), d(a[0], c[1]);
  return {Edge{a, b}, Edge{b, c}, Edge{c, d}, Edge{d, a}};
}

std::size_t Outline::row_of(double y) const
{
  const double row = std::floor((y - box_.lower[1]) * rows_per_length_);
  return static_cast<std::size_t>(std::clamp(row, 0.0, static_cast<double>(in_row_.size() - 1)));
}

bool Outline::holds(const Vector<2>& x) const
{
  if (edges_.empty() || !box_.contains(x)) return false;
  bool inside = false;
  for (const Index k : in_row_[row_of(x[1])]) {
    const auto& [a, b] = edges_[static_cast<std::size_t>(k)];
    if ((a[1] > x[1]) == (b[1] > x[1])) continue;
    inside ^= x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
  }
  return inside;
}
} // namespace pdx::geom
