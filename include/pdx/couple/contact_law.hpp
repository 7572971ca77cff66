#pragma once
#include "pdx/base/tensor.hpp"
#include "pdx/geom/frame.hpp"

#include <string>
#include <vector>

namespace pdx::couple {
/// A body that may touch others.
struct ContactBody {
  std::string name;   ///< as the user calls it
  double young = 0.0; ///< [Pa]
};

struct ContactOptions {
  double stiffness = 0.0; ///< modulus of the layer between two bodies; 0: that of their materials [Pa]
  double friction = 0.0;  ///< Coulomb's coefficient [-]
  double skin = 0.5;      ///< how far beyond their reach points are looked for, in sizes of the largest [-]
  double thickness = 1.0; ///< of plane bodies [m]
  geom::Frame frame;      ///< that messages count places in
  std::vector<std::array<Index, 2>> pairs; ///< bodies that may touch; empty: any two
};

/// Penalty between bodies: a point of size s (the side of its square or cube) and another body's skin push each other
/// apart by k (d0 - d) where they are nearer than d0 = (s_1 + s_2) / 2. Each body's points are held against the other's
/// skin, and both together are as stiff as the material that a layer of thickness d0 between the bodies would hold:
/// k = E A_1 A_2 / ((A_1 + A_2) d0), A = s t in the plane, s^2 in space, (s_1 + s_2) / E = s_1 / E_1 + s_2 / E_2. Two
/// lone points of one size and material push by E t (d0 - d) in the plane, E s (d0 - d) in space.
template <int Dim> class ContactLaw {
public:
  ContactLaw(std::vector<ContactBody> bodies, ContactOptions options);

  const std::vector<ContactBody>& bodies() const { return bodies_; }
  const ContactOptions& options() const { return options_; }
  bool may_touch(Index a, Index b) const { return pair(a, b) >= 0; }
  bool touches_any(Index body) const;
  /// Bodies that may touch, the lower number first, ascending.
  const std::vector<std::array<Index, 2>>& pairs() const { return options_.pairs; }
  /// Place in `pairs`, in either order; -1 if they may not touch.
  Index pair(Index a, Index b) const
  {
    return pair_[static_cast<std::size_t>(a) * bodies_.size() + static_cast<std::size_t>(b)];
  }

  /// k of a point against a skin, the same for both ways round [N/m].
  double stiffness(Index a, double size_a, Index b, double size_b) const;
  /// Tangential over normal stiffness where a point sticks: below the largest friction it gives way by that much [-].
  static constexpr double kStick = 0.125;
  /// What bodies that touch add to `Term::add_stiffness_bound` of a point of the first, in all directions [N/m]. As
  /// that of materials it is of the state at rest: flat faces, or a corner before a face, that just touch.
  double stiffness_bound(Index a, double size_a, Index b, double size_b) const;

private:
  std::vector<ContactBody> bodies_;
  ContactOptions options_;
  std::vector<Index> pair_; // bodies x bodies
};
} // namespace pdx::couple
