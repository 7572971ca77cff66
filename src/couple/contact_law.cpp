#include "pdx/couple/contact_law.hpp"

#include <algorithm>
#include <cmath>

namespace pdx::couple {
namespace {
/// Largest sum, over places along it, of what points in a row `ratio` times as dense as the nodes of a chain of
/// segments hand to one of its nodes.
double most_by_hats(double ratio)
{
  if (ratio <= 1.0) return 1.0;
  const double whole = std::floor(ratio);
  return 1.0 + 2.0 * whole - whole * (whole + 1.0) / ratio;
}

/// Largest eigenvalue of sum n n^T over the points of a flat square lattice that a point before it touches at once:
/// 2 around the middle between them, in space 4 too.
/// @param part (half the spacing of the lattice / d0)^2
template <int Dim> double most_before_a_face(double part)
{
  double most = 1.0;
  if (part < 1.0) most = std::max(most, 2.0 * std::max(1.0 - part, part));
  if (Dim == 3 && part < 0.5) most = std::max(most, 4.0 * std::max(1.0 - 2.0 * part, part));
  return most;
}
} // namespace

template <int Dim>
ContactLaw<Dim>::ContactLaw(std::vector<ContactBody> bodies, ContactOptions options)
    : bodies_(std::move(bodies)), options_(std::move(options)), pair_(bodies_.size() * bodies_.size(), -1)
{
  auto& pairs = options_.pairs;
  const auto count = static_cast<Index>(bodies_.size());
  if (pairs.empty())
    for (Index a = 0; a < count; ++a)
      for (Index b = a + 1; b < count; ++b) pairs.push_back({a, b});
  for (auto& pair : pairs) std::ranges::sort(pair);
  std::ranges::sort(pairs);
  const auto repeated = std::ranges::unique(pairs);
  pairs.erase(repeated.begin(), repeated.end());
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const auto a = static_cast<std::size_t>(pairs[k][0]), b = static_cast<std::size_t>(pairs[k][1]);
    pair_[a * bodies_.size() + b] = pair_[b * bodies_.size() + a] = static_cast<Index>(k);
  }
}

template <int Dim> bool ContactLaw<Dim>::touches_any(Index body) const
{
  return std::ranges::any_of(options_.pairs, [&](const auto& pair) { return pair[0] == body || pair[1] == body; });
}

template <int Dim> double ContactLaw<Dim>::stiffness(Index a, double size_a, Index b, double size_b) const
{
  const double young_a = bodies_[static_cast<std::size_t>(a)].young,
               young_b = bodies_[static_cast<std::size_t>(b)].young;
  const double modulus =
      options_.stiffness > 0.0 ? options_.stiffness : (size_a + size_b) / (size_a / young_a + size_b / young_b);
  const double area_a = Dim == 2 ? size_a * options_.thickness : size_a * size_a,
               area_b = Dim == 2 ? size_b * options_.thickness : size_b * size_b;
  return modulus * area_a * area_b / (area_a + area_b) / (0.5 * (size_a + size_b));
}

/// The gap of a point p before the place c = sum w_i x_i of a skin: k (n.(u_p - u_c))^2 <= 2 k (n.u_p)^2 + 2 k sum w_i
/// (n.u_i)^2. A point of `a` is p once, and a node of its skin for the points of `b` around it. Friction adds
/// kStick k |t + y|^2, t the tangential part of u_p - u_c and y = d0 sum g_i (n.u_i) what the tilt of the facet adds,
/// g_i the gradients of w_i. In (t + y)^2 <= t^2 / kStick + y^2 / (1 - kStick) the first fits the bound there is; the
/// second is (sum |g_i|) sum |g_i| (n.u_i)^2.
template <int Dim> double ContactLaw<Dim>::stiffness_bound(Index a, double size_a, Index b, double size_b) const
{
  const double k = stiffness(a, size_a, b, size_b), d0 = 0.5 * (size_a + size_b), ratio = size_a / size_b;
  const double by_hats = std::pow(most_by_hats(ratio), Dim - 1);
  const double before_a_face = most_before_a_face<Dim>(0.25 * size_b * size_b / (d0 * d0));
  double bound = 2.0 * k * (1.0 + std::max(by_hats, before_a_face));
  if (options_.friction > 0.0) {
    constexpr double kSlopes = Dim == 2 ? 2.0 : 4.83; // (sum |g_i|) max |g_i| size^2 of a segment, half a square
    const double around = std::pow(std::max(1.0, 2.0 * ratio), Dim - 1); // points of b at facets of one of a
    bound += k * kStick / (1.0 - kStick) * kSlopes * around * d0 * d0 / (size_a * size_a);
  }
  return bound;
}

template class ContactLaw<2>;
template class ContactLaw<3>;
} // namespace pdx::couple
