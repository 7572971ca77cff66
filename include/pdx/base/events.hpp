#pragma once
#include "pdx/base/petsc.hpp"

#include <map>
#include <string>

namespace pdx {
/// One named PETSc log event, registered on first use: a scene that never runs it leaves no trace of it.
/// Names begin with their room: fe_, pd_, couple_, solve_, io_, post_.
class Event {
public:
  explicit Event(const char* name) : name_(name) {}
  void begin();
  void end();

private:
  const char* name_;
  PetscLogEvent id_ = -1;
};

/// Times the enclosing block under an event: `static Event event("pd_force"); Timed timed(event);`
class Timed {
public:
  explicit Timed(Event& event) : event_(event) { event_.begin(); }
  ~Timed() { event_.end(); }
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;

private:
  Event& event_;
};

struct EventCount {
  int count = 0;        ///< times entered on this rank [-]
  double seconds = 0.0; ///< time inside, on this rank  [s]
};
/// Counts of all our events since the start, by name; events of reference runs (`PauseCounts`) are left out.
std::map<std::string, EventCount> event_counts();

/// While alive, work is not counted: for reference solutions that are no part of the scene.
class PauseCounts {
public:
  PauseCounts();
  ~PauseCounts();
  PauseCounts(const PauseCounts&) = delete;
  PauseCounts& operator=(const PauseCounts&) = delete;
};
} // namespace pdx
