#pragma once
#include "pdx/couple/contact_law.hpp"
#include "pdx/couple/contact_skin.hpp"

namespace pdx::couple {
/// Points that may come to touch a skin before any moves by more than `slack`, found by a grid of cells.
template <int Dim> class ContactList {
public:
  /// A point before the skin of another body.
  struct Near {
    Index point = 0, body = 0;
    Index begin = 0, end = 0; ///< of `facets`
  };

  /// @param x places of all points as they are now [m]
  /// @param mine 1 per point that this rank moves: only what may move one of them is listed; empty: everything is
  /// @param beyond their reach points are looked for [m]
  void renew(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law, std::span<const Vector<Dim>> x,
             std::span<const std::uint8_t> mine, double beyond);
  /// Has these points take part too.
  void join(std::span<const Index> points);

  std::span<const Near> near() const { return near_; } ///< ascending by point, then body
  std::span<const Index> facets(const Near& near) const
  {
    return {facets_.data() + near.begin, static_cast<std::size_t>(near.end - near.begin)};
  }
  std::span<const Index> points() const { return points_; } ///< all that take part, ascending
  double slack() const { return slack_; }                   ///< [m]
  /// Between the boxes of bodies that may touch, in the order of `ContactLaw::pairs`; infinite where one has no point.
  std::span<const double> gaps() const { return gaps_; } ///< [m]

private:
  struct Box {
    Vector<Dim> lower, upper;
    bool empty = true;
  };
  struct Entry {
    Index body, facet;
  };
  void find_boxes(const ContactSkin<Dim>& skin, std::span<const Vector<Dim>> x, std::size_t bodies);
  void choose(const ContactSkin<Dim>& skin, const ContactLaw<Dim>& law, std::span<const Vector<Dim>> x, double beyond);
  void add(const ContactSkin<Dim>& skin, Index point, std::span<const std::uint8_t> mine);

  std::vector<Near> near_;
  std::vector<Index> facets_, points_;
  double slack_ = 0.0;
  std::vector<double> gaps_;

  std::vector<Box> boxes_;               // of bodies
  std::vector<Index> chosen_;            // points near another body's box
  std::vector<Vector<Dim>> places_;      // theirs
  std::vector<Index> stamp_;             // per facet: the last point that listed it
  std::vector<std::uint8_t> takes_part_; // per point
  std::vector<Entry> entries_;
  double reach_ = 0.0; // of any point
};
} // namespace pdx::couple
