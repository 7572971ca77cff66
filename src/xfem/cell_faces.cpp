#include "cell_faces.hpp"

#include "pdx/base/joined.hpp"
#include "pdx/geom/orientation.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <tuple>

namespace pdx::xfem {
namespace {
using geom::orientation;
using Pair = std::pair<int, int>;
constexpr double kFlat = 1e-13; // sine of a turn that rounding may have made

Pair sorted(int a, int b) { return std::minmax(a, b); }

/// All triangles of a cell whose border and walls are edges of them.
class Triangles {
public:
  Triangles(const std::vector<FacePoint>& points, int border, const std::vector<Pair>& walls) : points_(points)
  {
    for (int k = 0; k < border; ++k) add(k, (k + 1) % border);
    for (const auto& [a, b] : walls) add(a, b);
    add_diagonals();
  }

  std::vector<std::array<int, 3>> find() const
  {
    std::vector<std::array<int, 3>> all;
    for (const auto& [a, b] : edges_)
      for (int c = b + 1; c < size(); ++c) {
        if (!has(a, c) || !has(b, c)) continue;
        const int turn = orientation(at(a), at(b), at(c));
        if (turn == 0) continue;
        const std::array<int, 3> triangle = turn > 0 ? std::array{a, b, c} : std::array{a, c, b};
        if (is_empty(triangle)) all.push_back(triangle);
      }
    return all;
  }

private:
  int size() const { return static_cast<int>(points_.size()); }
  const Vector<2>& at(int k) const { return points_[static_cast<std::size_t>(k)].at; }
  bool has(int a, int b) const { return edges_.contains(sorted(a, b)); }
  void add(int a, int b) { edges_.insert(sorted(a, b)); }

  /// Shortest ones first, as long as they cross nothing.
  void add_diagonals()
  {
    std::vector<std::tuple<double, int, int>> all;
    for (int a = 0; a < size(); ++a)
      for (int b = a + 1; b < size(); ++b) {
        const bool along_border =
            (points_[static_cast<std::size_t>(a)].edges & points_[static_cast<std::size_t>(b)].edges) != 0;
        if (!along_border && !has(a, b)) all.emplace_back((at(a) - at(b)).squaredNorm(), a, b);
      }
    std::ranges::sort(all);
    for (const auto& [length, a, b] : all)
      if (is_free(a, b)) add(a, b);
  }
  bool is_free(int a, int b) const
  {
    for (int k = 0; k < size(); ++k)
      if (k != a && k != b && orientation(at(a), at(b), at(k)) == 0 && (at(k) - at(a)).dot(at(k) - at(b)) < 0.0)
        return false;
    return std::ranges::none_of(edges_, [&](const Pair& edge) {
      const auto& [p, q] = edge;
      if (p == a || p == b || q == a || q == b) return false;
      return orientation(at(a), at(b), at(p)) * orientation(at(a), at(b), at(q)) < 0 &&
             orientation(at(p), at(q), at(a)) * orientation(at(p), at(q), at(b)) < 0;
    });
  }
  bool is_empty(const std::array<int, 3>& t) const
  {
    for (int k = 0; k < size(); ++k)
      if (k != t[0] && k != t[1] && k != t[2] && orientation(at(t[0]), at(t[1]), at(k)) >= 0 &&
          orientation(at(t[1]), at(t[2]), at(k)) >= 0 && orientation(at(t[2]), at(t[0]), at(k)) >= 0)
        return false;
    return true;
  }

  const std::vector<FacePoint>& points_;
  std::set<Pair> edges_; // lower number first
};

bool is_convex(const std::vector<FacePoint>& points, const std::vector<int>& outline)
{
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const auto at = [&](std::size_t j) -> const Vector<2>& {
      return points[static_cast<std::size_t>(outline[(k + j) % outline.size()])].at;
    };
    const Vector<2> in = at(1) - at(0), out = at(2) - at(1);
    if (in.x() * out.y() - in.y() * out.x() < -kFlat * in.norm() * out.norm()) return false;
  }
  return true;
}

/// Two outlines as one without the edge that they share; empty: they share none.
std::vector<int> merged(const std::vector<int>& a, const std::vector<int>& b)
{
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) {
      if (a[i] != b[(j + 1) % b.size()] || a[(i + 1) % a.size()] != b[j]) continue;
      std::vector<int> both;
      for (std::size_t k = 1; k <= a.size(); ++k) both.push_back(a[(i + k) % a.size()]);
      for (std::size_t k = 2; k < b.size(); ++k) both.push_back(b[(j + k) % b.size()]);
      return both;
    }
  return {};
}

/// Joins outlines as long as that leaves them convex.
void merge(const std::vector<FacePoint>& points, std::vector<std::vector<int>>& outlines)
{
  for (std::size_t i = 0; i < outlines.size(); ++i)
    for (std::size_t j = i + 1; j < outlines.size();) {
      std::vector<int> both = merged(outlines[i], outlines[j]);
      if (both.empty() || !is_convex(points, both)) {
        ++j;
        continue;
      }
      outlines[i] = std::move(both);
      outlines.erase(outlines.begin() + static_cast<std::ptrdiff_t>(j));
      j = i + 1;
    }
}
} // namespace

CellFaces faces_of(const std::vector<FacePoint>& points, int border, const std::vector<Pair>& walls)
{
  std::set<Pair> wall;
  for (const auto& [a, b] : walls) wall.insert(sorted(a, b));
  const std::vector<std::array<int, 3>> triangles = Triangles(points, border, walls).find();
  std::map<Pair, std::size_t> at_left;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) at_left[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  Joined joined(triangles.size());
  for (const auto& [line, triangle] : at_left)
    if (const auto other = at_left.find({line.second, line.first});
        other != at_left.end() && !wall.contains(sorted(line.first, line.second)))
      joined.join(triangle, other->second);
  CellFaces faces;
  std::map<std::size_t, int> face_of; // by root
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto [face, fresh] = face_of.try_emplace(joined.root(t), static_cast<int>(faces.polygons.size()));
    if (fresh) faces.polygons.emplace_back();
    faces.polygons[static_cast<std::size_t>(face->second)].emplace_back(triangles[t].begin(), triangles[t].end());
  }
  for (const auto& [line, triangle] : at_left) faces.left_of[line] = face_of.at(joined.root(triangle));
  for (std::vector<std::vector<int>>& outlines : faces.polygons) merge(points, outlines);
  return faces;
}
} // namespace pdx::xfem
