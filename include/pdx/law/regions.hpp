#pragma once
#include "pdx/geom/outline.hpp"
#include "pdx/law/elastic.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace pdx::law {
/// What a part of the body is made of.
struct Region {
  std::string name;
  geom::Outline outline;
  Elastic elastic;
  double toughness; ///< energy release rate Gc; infinity: nothing breaks there   [J/m^2]
};

/// Energy release rate of the bonds between two regions, by number.
struct Interface {
  std::size_t a, b;
  double toughness; ///< [J/m^2]
};

/// A body of several materials. Regions have the numbers 1, 2, ... in order; 0 is what lies in none of them. Where
/// they overlap, the later one counts.
class Regions {
public:
  static constexpr std::size_t kMost = 255;

  /// @param rest of what lies in no region   @param toughness of that, infinity: nothing breaks there [J/m^2]
  /// @param reference the energy release rate that critical stretches are told by; above 0 [J/m^2]
  Regions(const Elastic& rest, double toughness, double reference, std::vector<Region> regions,
          std::span<const Interface> interfaces);

  std::size_t count() const { return regions_.size() + 1; } ///< with 0
  std::uint8_t at(const Vector<2>& x) const;
  const Elastic& elastic(std::size_t region) const { return region ? regions_[region - 1].elastic : rest_; }
  const std::string& name(std::size_t region) const { return regions_[region - 1].name; } ///< from 1 on

  /// Of a bond between two regions over one in region 0: two springs in a row, each as stiff as E t. [-]
  double stiffness(std::size_t a, std::size_t b) const { return stiffness_[a * count() + b]; }
  /// Critical stretch of such a bond over that of one in region 0 with the reference toughness: the energy it takes is
  /// as stretch squared and stiffness, and is Gc t. Infinity: it never breaks. Between two regions the smaller
  /// toughness counts, if the interface has none of its own. [-]
  double stretch(std::size_t a, std::size_t b) const { return stretch_[a * count() + b]; }

  bool one_elastic() const { return one_elastic_; }       ///< are all made of one solid?
  bool one_stretch() const { return one_stretch_; }       ///< do all bonds break at the reference's critical stretch?
  double least_stretch() const { return least_stretch_; } ///< the smallest of `stretch` [-]

private:
  Elastic rest_;
  std::vector<Region> regions_;
  std::vector<double> stiffness_, stretch_; // by pairs of regions
  bool one_elastic_ = true, one_stretch_ = true;
  double least_stretch_ = 1.0;
};

/// Are all numbers the same?
bool same(const Elastic& a, const Elastic& b);
} // namespace pdx::law
