#include "pdx/app/contact_grips.hpp"

#include "pdx/base/gather.hpp"

#include <algorithm>

namespace pdx::app {
template <int Dim> std::optional<NamedGrips> named_grips(MPI_Comm comm, const couple::ContactTerm<Dim>* contact)
{
  if (!contact || contact->law().options().friction == 0.0) return std::nullopt;
  auto all = gather_all(comm, contact->grips());
  std::ranges::sort(all, {}, [](const auto& grip) { return std::pair(grip.point, grip.body); });
  NamedGrips named;
  for (const couple::NamedGrip<Dim>& grip : all) {
    named.names.insert(named.names.end(), {grip.point, grip.body});
    named.names.insert(named.names.end(), grip.points.begin(), grip.points.end());
    named.numbers.insert(named.numbers.end(), grip.weights.begin(), grip.weights.end());
    named.numbers.push_back(grip.stretch);
  }
  return named;
}

template <int Dim> void hold_grips(couple::ContactTerm<Dim>* contact, const NamedGrips& named)
{
  if (!contact) return;
  std::vector<couple::NamedGrip<Dim>> all(named.names.size() / (2 + Dim));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const std::uint64_t* names = named.names.data() + k * (2 + Dim);
    const double* numbers = named.numbers.data() + k * (1 + Dim);
    all[k].point = names[0];
    all[k].body = names[1];
    std::copy_n(names + 2, Dim, all[k].points.begin());
    std::copy_n(numbers, Dim, all[k].weights.begin());
    all[k].stretch = numbers[Dim];
  }
  contact->set_grips(all);
}

template std::optional<NamedGrips> named_grips<2>(MPI_Comm, const couple::ContactTerm<2>*);
template std::optional<NamedGrips> named_grips<3>(MPI_Comm, const couple::ContactTerm<3>*);
template void hold_grips<2>(couple::ContactTerm<2>*, const NamedGrips&);
template void hold_grips<3>(couple::ContactTerm<3>*, const NamedGrips&);
} // namespace pdx::app
