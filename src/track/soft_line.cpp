#include "soft_line.hpp"

namespace pdx::track {
namespace {
constexpr double kMargin = 0.15; // spacings
constexpr int kRounds = 30;
constexpr double kLargestMove = 0.2, kLargestTurn = 0.1; // in a round, spacings and slope
constexpr double kSettled = 1e-12;
} // namespace

Line soft_line(std::span<const Labelled> points, const Line& line, const Stiffness& stiffness)
{
  Vector<2> x = Vector<2>::Zero(); // offset and slope
  for (int round = 0; round < kRounds; ++round) {
    double aa = stiffness.offset, ab = 0.0, bb = stiffness.slope;
    Vector<2> force(-aa * x[0], -bb * x[1]);
    for (const Labelled& p : points) {
      const double place = line.along.dot(p.at - line.at);
      const double margin = p.side * (line.offset(p.at) - x[0] - x[1] * place) / kMargin;
      const double wrong = 1.0 / (1.0 + std::exp(margin));
      const double pull = -p.weight * p.side * wrong / kMargin;
      const double hold = p.weight * wrong * (1.0 - wrong) / (kMargin * kMargin);
      force += pull * Vector<2>(1.0, place);
      aa += hold;
      ab += hold * place;
      bb += hold * place * place;
    }
    const double det = aa * bb - ab * ab;
    if (!(det > 1e-12 * aa * bb)) break;
    Vector<2> move = Vector<2>(bb * force[0] - ab * force[1], aa * force[1] - ab * force[0]) / det;
    move *= std::min({1.0, kLargestMove / std::abs(move[0]), kLargestTurn / std::abs(move[1])});
    x += move;
    if (move.norm() < kSettled) break;
  }
  return {line.at + x[0] * left_of(line.along), (line.along + x[1] * left_of(line.along)).normalized()};
}
} // namespace pdx::track
