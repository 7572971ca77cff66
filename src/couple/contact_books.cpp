#include "pdx/couple/contact_books.hpp"

#include <algorithm>

namespace pdx::couple {
namespace {
constexpr std::size_t kOfPair = 6; // numbers in the sums: force, impulse

template <int Dim> std::vector<ContactBooks::Pair> names_of(const ContactLaw<Dim>& law)
{
  std::vector<ContactBooks::Pair> names;
  for (const auto& [a, b] : law.pairs())
    names.push_back({law.bodies()[static_cast<std::size_t>(a)].name, law.bodies()[static_cast<std::size_t>(b)].name});
  return names;
}
} // namespace

ContactBooks::ContactBooks(std::vector<Pair> pairs) : pairs_(std::move(pairs))
{
  now_.force.resize(pairs_.size());
  now_.impulse.resize(pairs_.size());
  saved_ = now_;
}

std::vector<double> ContactBooks::sums() const
{
  std::vector<double> sums{now_.friction};
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    sums.insert(sums.end(), now_.force[k].begin(), now_.force[k].end());
    sums.insert(sums.end(), now_.impulse[k].begin(), now_.impulse[k].end());
  }
  return sums;
}

void ContactBooks::resume(std::span<const double> sums)
{
  if (sums.size() != 1 + kOfPair * pairs_.size()) throw std::logic_error("sums of contact are of other bodies");
  now_.friction = sums[0];
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(1 + kOfPair * k), 3, now_.force[k].begin());
    std::copy_n(sums.begin() + static_cast<std::ptrdiff_t>(4 + kOfPair * k), 3, now_.impulse[k].begin());
  }
  saved_ = now_;
}

template <int Dim>
ContactStep<Dim>::ContactStep(ContactTerm<Dim>& contact) : ContactBooks(names_of(contact.law())), contact_(contact)
{}

template <int Dim> std::array<double, 3> ContactStep<Dim>::force(std::size_t pair) const
{
  std::array<double, 3> force{};
  std::copy_n(contact_.pair_forces()[pair].data(), Dim, force.begin());
  return force;
}

template <int Dim> void ContactStep<Dim>::stepped(double length)
{
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    const std::array<double, 3> after = force(k);
    for (std::size_t d = 0; d < 3; ++d) now_.impulse[k][d] += 0.5 * length * (now_.force[k][d] + after[d]);
    now_.force[k] = after;
  }
}

template <int Dim> void ContactStep<Dim>::apply(std::span<const double>, field::ForceLosses&)
{
  now_.friction += contact_.slip();
}

template <int Dim> void ContactStep<Dim>::save()
{
  saved_ = now_;
  contact_.save();
}

template <int Dim> void ContactStep<Dim>::restore()
{
  now_ = saved_;
  contact_.restore();
}

template class ContactStep<2>;
template class ContactStep<3>;
} // namespace pdx::couple
