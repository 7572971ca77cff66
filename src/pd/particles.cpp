#include "pdx/pd/particles.hpp"

#include <algorithm>
#include <petscdmswarm.h>
#include <tuple>

namespace pdx::pd {
namespace {
constexpr PetscInt kBuffer = 100; // a larger one is cleared for every particle that leaves

/// Borrows one field of the swarm for the lifetime of this object.
template <class T> class Borrowed {
public:
  Borrowed(DM swarm, const char* name) : swarm_(swarm), name_(name)
  {
    PDX_CALL(DMSwarmGetField(swarm, name, nullptr, nullptr, reinterpret_cast<void**>(&data_)));
  }
  ~Borrowed() { (void)DMSwarmRestoreField(swarm_, name_, nullptr, nullptr, reinterpret_cast<void**>(&data_)); }
  Borrowed(const Borrowed&) = delete;
  Borrowed& operator=(const Borrowed&) = delete;
  T& operator[](std::size_t k) { return data_[k]; }

private:
  DM swarm_;
  const char* name_;
  T* data_ = nullptr;
};
} // namespace

Particles::Particles(MPI_Comm comm)
{
  PDX_CALL(DMCreate(comm, swarm_.out()));
  DM sw = swarm_.get();
  PDX_CALL(DMSetType(sw, DMSWARM));
  PDX_CALL(DMSetDimension(sw, 2));
  PDX_CALL(DMSwarmSetType(sw, DMSWARM_BASIC));
  PDX_CALL(DMSwarmInitializeFieldRegister(sw));
  PDX_CALL(DMSwarmRegisterPetscDatatypeField(sw, "x", 2, PETSC_REAL));
  PDX_CALL(DMSwarmRegisterPetscDatatypeField(sw, "patch", 1, PETSC_INT));
  PDX_CALL(DMSwarmRegisterPetscDatatypeField(sw, "site", 1, PETSC_INT));
  PDX_CALL(DMSwarmRegisterPetscDatatypeField(sw, "cell", 1, PETSC_INT));
  PDX_CALL(DMSwarmFinalizeFieldRegister(sw));
  PDX_CALL(DMSwarmSetLocalSizes(sw, 0, kBuffer));
}

Index Particles::local_size() const
{
  PetscInt n = 0;
  PDX_CALL(DMSwarmGetLocalSize(swarm_.get(), &n));
  return n;
}

void Particles::add(std::span<const Particle> particles)
{
  const auto before = static_cast<std::size_t>(local_size());
  if (particles.empty()) return;
  if (!before)
    PDX_CALL(DMSwarmSetLocalSizes(swarm_.get(), static_cast<PetscInt>(particles.size()), kBuffer));
  else
    PDX_CALL(DMSwarmAddNPoints(swarm_.get(), static_cast<PetscInt>(particles.size())));
  Borrowed<double> x(swarm_.get(), "x");
  Borrowed<PetscInt> patch(swarm_.get(), "patch"), site(swarm_.get(), "site"), cell(swarm_.get(), "cell");
  for (std::size_t k = 0; k < particles.size(); ++k) {
    x[2 * (before + k)] = particles[k].x[0];
    x[2 * (before + k) + 1] = particles[k].x[1];
    patch[before + k] = particles[k].patch;
    site[before + k] = particles[k].site;
    cell[before + k] = particles[k].cell;
  }
}

void Particles::migrate(std::span<const int> owner)
{
  {
    Borrowed<PetscInt> rank(swarm_.get(), DMSwarmField_rank), cell(swarm_.get(), "cell");
    for (std::size_t k = 0; k < owner.size(); ++k) {
      rank[k] = owner[k];
      cell[k] = -1;
    }
  }
  PDX_CALL(DMSwarmMigrate(swarm_.get(), PETSC_TRUE));
}

std::vector<Particle> Particles::sorted() const
{
  std::vector<Particle> all(static_cast<std::size_t>(local_size()));
  if (!all.empty()) {
    Borrowed<double> x(swarm_.get(), "x");
    Borrowed<PetscInt> patch(swarm_.get(), "patch"), site(swarm_.get(), "site"), cell(swarm_.get(), "cell");
    for (std::size_t k = 0; k < all.size(); ++k)
      all[k] = {patch[k], site[k], cell[k], Vector<2>(x[2 * k], x[2 * k + 1])};
  }
  const auto by_site = [](const Particle& a, const Particle& b) {
    return std::tie(a.patch, a.site) < std::tie(b.patch, b.site);
  };
  if (!std::is_sorted(all.begin(), all.end(), by_site)) std::sort(all.begin(), all.end(), by_site);
  return all;
}
} // namespace pdx::pd
