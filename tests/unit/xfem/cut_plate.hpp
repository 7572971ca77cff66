#pragma once
#include "pdx/fem/elastic_kernel.hpp"
#include "pdx/xfem/enriched_kernel.hpp"
#include "pdx/xfem/enrichment.hpp"

#include <cmath>
#include <numbers>
#include <random>

/// A straight crack without ends.
struct Line {
  pdx::Vector<2> through; ///< [m]
  double angle;           ///< from x to the crack [rad]; the plus side is on its left

  pdx::Vector<2> along() const { return {std::cos(angle), std::sin(angle)}; }
  double distance(const pdx::Vector<2>& x) const
  {
    return (x - through).dot(pdx::Vector<2>(-along().y(), along().x()));
  }
};

/// n x n cells of side h, sheared by `shape`, cut by a line; with the unknowns of elements and enriched sets.
struct CutPlate {
  static constexpr double kYoung = 70e9, kThickness = 2e-3;
  pdx::law::Elastic law{kYoung, 0.3, pdx::law::Plane::stress, kThickness};
  pdx::law::Kinematics kinematics = pdx::law::Kinematics::small;
  pdx::xfem::EnrichmentRule rule;
  int n;
  double h;
  std::vector<std::array<pdx::Index, 4>> cells;
  std::vector<pdx::Vector<2>> points;
  std::vector<pdx::Index> active;
  std::vector<pdx::xfem::CellCut> cuts;
  pdx::xfem::Enrichment enrichment;

  CutPlate(int count, double side, const pdx::Tensor<2>& shape = pdx::Tensor<2>::Identity()) : n(count), h(side)
  {
    for (int j = 0; j <= n; ++j)
      for (int i = 0; i <= n; ++i) points.push_back(shape * pdx::Vector<2>(i * h, j * h));
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        active.push_back(static_cast<pdx::Index>(cells.size()));
        cells.push_back({node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)});
      }
  }

  pdx::Index node(int i, int j) const { return i + (n + 1) * j; }
  const pdx::Vector<2>& point(pdx::Index v) const { return points[static_cast<std::size_t>(v)]; }
  pdx::xfem::MeshView view() const { return {cells, points, active}; }

  /// Cuts every cell with corners on both sides of the line; `keep` may spare some.
  template <class Keep> void cut(const Line& line, Keep&& keep)
  {
    cuts.clear();
    for (const pdx::Index c : active) {
      pdx::xfem::CornerDistances distance;
      for (std::size_t a = 0; a < 4; ++a) distance[a] = line.distance(point(cells[static_cast<std::size_t>(c)][a]));
      const bool first = distance[0] < 0.0;
      if (std::ranges::any_of(distance, [&](double d) { return (d < 0.0) != first; }) && keep(c))
        cuts.push_back({c, 0, distance});
    }
    enrichment = pdx::xfem::enrich(view(), cuts, rule);
  }
  void cut(const Line& line)
  {
    cut(line, [](pdx::Index) { return true; });
  }

  int unknowns() const { return 2 * static_cast<int>(points.size() + enrichment.nodes.size()); }

  /// Calls visit(element, unknowns of the element, corners, is it cut).
  template <class Visit> void for_each_cell(Visit&& visit) const
  {
    std::vector<int> cut_number(cells.size(), -1);
    for (std::size_t i = 0; i < cuts.size(); ++i)
      cut_number[static_cast<std::size_t>(cuts[i].cell)] = static_cast<int>(i);
    for (const pdx::Index c : active) {
      const auto& cell = cells[static_cast<std::size_t>(c)];
      std::vector<int> at;
      for (const pdx::Index v : cell) at.insert(at.end(), {2 * v, 2 * v + 1});
      pdx::xfem::EnrichedElement element;
      const int number = cut_number[static_cast<std::size_t>(c)];
      if (number < 0) {
        element.cell = pdx::xfem::whole_cell(view().corners(c), pdx::xfem::Side::plus);
      } else {
        const auto i = static_cast<std::size_t>(number);
        element = pdx::xfem::enriched_element(view(), cuts, i, enrichment, rule.quadrature);
        for (const pdx::Index set : pdx::xfem::sets_of(view(), cuts[i], enrichment))
          if (set >= 0) {
            const int first = 2 * (static_cast<int>(points.size()) + set);
            at.insert(at.end(), {first, first + 1});
          }
      }
      visit(element, at);
    }
  }

  Eigen::VectorXd force(const Eigen::VectorXd& d) const
  {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(unknowns());
    for_each_cell([&](const auto& element, const std::vector<int>& at) {
      const pdx::xfem::EnrichedVector local = d(at);
      sum(at) += pdx::xfem::enriched_force(element, local, law, kinematics);
    });
    return sum;
  }

  /// Tangent of the undeformed plate.
  Eigen::MatrixXd rest_tangent() const
  {
    const Eigen::VectorXd d = Eigen::VectorXd::Zero(unknowns());
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(unknowns(), unknowns());
    for_each_cell([&](const auto& element, const std::vector<int>& at) {
      const pdx::xfem::EnrichedVector local = d(at);
      sum(at, at) += pdx::xfem::enriched_tangent(element, local, law, kinematics);
    });
    return sum;
  }

  /// Unknowns of a displacement that is field(x, side) on either side. A node whose row was dropped takes the field of
  /// the side with more of its support.
  template <class Field> Eigen::VectorXd unknowns_of(const Line& line, Field&& field) const
  {
    using namespace pdx::xfem;
    Eigen::VectorXd d = Eigen::VectorXd::Zero(unknowns());
    for (pdx::Index v = 0; v < static_cast<pdx::Index>(points.size()); ++v)
      d.segment<2>(2 * v) = field(point(v), side_of(line.distance(point(v))));
    for (const NodeSupport& held : enrichment.dropped)
      if (held.verdict == Verdict::share) d.segment<2>(2 * held.node) = field(point(held.node), held.lean);
    for (std::size_t s = 0; s < enrichment.nodes.size(); ++s) {
      const NodeSupport& rich = enrichment.nodes[s];
      const Side other = opposite(rich.side);
      const auto first = static_cast<Eigen::Index>(2 * (points.size() + s));
      d.segment<2>(first) =
          (field(point(rich.node), other) - field(point(rich.node), rich.side)) / shifted_step(other, rich.side);
    }
    return d;
  }
};
