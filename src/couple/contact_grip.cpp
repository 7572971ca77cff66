#include "pdx/couple/contact_grip.hpp"

#include <Eigen/Geometry>

namespace pdx::couple {
namespace {
constexpr double kUpright = 0.1; // least cosine between a normal and that of the facet it once stood on

/// A facet's normal, and the gradients of the weights of its points.
template <int Dim> struct Plane {
  Vector<Dim> normal;
  std::array<Vector<Dim>, Dim> slopes;

  /// @param side the normal is to look to
  Plane(const std::array<Index, Dim>& points, std::span<const Vector<Dim>> x, const Vector<Dim>& side)
  {
    const auto corner = [&](std::size_t k) -> const Vector<Dim>& { return x[static_cast<std::size_t>(points[k])]; };
    if constexpr (Dim == 2) {
      const Vector<2> along = corner(1) - corner(0);
      slopes[1] = along / along.squaredNorm();
      slopes[0] = -slopes[1];
      normal = Vector<2>(-along.y(), along.x()).normalized();
    } else {
      const Vector<3> b = corner(1) - corner(0), c = corner(2) - corner(0), across = b.cross(c);
      slopes[1] = c.cross(across) / across.squaredNorm();
      slopes[2] = across.cross(b) / across.squaredNorm();
      slopes[0] = -slopes[1] - slopes[2];
      normal = across.normalized();
    }
    if (normal.dot(side) < 0.0) normal = -normal;
  }
  Vector<Dim> along(const Vector<Dim>& v) const { return v - normal.dot(v) * normal; }
};

template <int Dim> Vector<Dim> place_of(const Grip<Dim>& grip, std::span<const Vector<Dim>> x)
{
  Vector<Dim> place = Vector<Dim>::Zero();
  for (std::size_t k = 0; k < Dim; ++k) place += grip.weights[k] * x[static_cast<std::size_t>(grip.points[k])];
  return place;
}

/// From the grip to the point along the facet that is touched, which may be another than that of the grip; none if the
/// normal lies on that.
template <int Dim>
std::optional<Vector<Dim>> stretched(const Grip<Dim>& grip, const Plane<Dim>& plane, const Touch<Dim>& touch,
                                     std::span<const Vector<Dim>> x, bool same)
{
  const Vector<Dim> from = x[static_cast<std::size_t>(grip.point)] - place_of<Dim>(grip, x);
  if (same) return plane.along(from);
  const Plane<Dim> old(grip.points, x, touch.normal);
  if (old.normal.dot(touch.normal) < kUpright) return std::nullopt;
  const Vector<Dim> tau = old.along(from), both = old.normal + plane.normal;
  return tau - plane.normal.dot(tau) / (1.0 + old.normal.dot(plane.normal)) * both; // turned from normal to normal
}
} // namespace

template <int Dim> void Traction<Dim>::add_forces(double stiffness, std::span<Vector<Dim>> forces) const
{
  forces[static_cast<std::size_t>(grip.point)] += stiffness * tau;
  for (std::size_t k = 0; k < Dim; ++k)
    forces[static_cast<std::size_t>(grip.points[k])] +=
        stiffness * (height * tau.dot(slopes[k]) * normal - grip.weights[k] * tau);
}

template <int Dim>
std::optional<Traction<Dim>> traction_of(const ContactSkin<Dim>& skin, const Touch<Dim>& touch,
                                         std::span<const Vector<Dim>> x, Index point, const Grip<Dim>* before,
                                         double limit)
{
  const auto& facet = skin.facet(touch.facet);
  if (facet.count < Dim) return std::nullopt;
  const Plane<Dim> plane(facet.points, x, touch.normal);
  const bool same = before && before->points == facet.points;
  const std::optional<Vector<Dim>> tau = before ? stretched<Dim>(*before, plane, touch, x, same) : std::nullopt;
  Traction<Dim> traction;
  traction.normal = plane.normal;
  traction.slopes = plane.slopes;
  traction.tau = tau.value_or(Vector<Dim>::Zero());
  const double length = traction.tau.norm();
  const bool slips = length > limit;
  if (before && !tau) traction.slip_energy = 0.5 * before->stretch * before->stretch;
  if (slips) {
    traction.slip_energy = 0.5 * (before->stretch + limit) * (length - limit);
    traction.tau *= limit / length;
  }
  if (same && !slips) {
    traction.grip = *before;
  } else {
    traction.grip = {point, skin.point(facet.points[0]).body, facet.points, touch.weights};
    const Vector<Dim> back = plane.along(touch.distance * touch.normal) - traction.tau; // from the touch to the grip
    for (std::size_t k = 0; k < Dim; ++k) traction.grip.weights[k] += plane.slopes[k].dot(back);
  }
  traction.grip.stretch = std::min(length, limit);
  traction.height = plane.normal.dot(x[static_cast<std::size_t>(point)] - place_of<Dim>(traction.grip, x));
  return traction;
}

template struct Traction<2>;
template struct Traction<3>;
template std::optional<Traction<2>> traction_of<2>(const ContactSkin<2>&, const Touch<2>&, std::span<const Vector<2>>,
                                                   Index, const Grip<2>*, double);
template std::optional<Traction<3>> traction_of<3>(const ContactSkin<3>&, const Touch<3>&, std::span<const Vector<3>>,
                                                   Index, const Grip<3>*, double);
} // namespace pdx::couple
