#pragma once
#include "pdx/field/output_field.hpp"
#include "pdx/io/hdf5_file.hpp"
#include "pdx/io/kept_tables.hpp"

#include <filesystem>
#include <span>
#include <string>

namespace pdx::io {
/// The pictures of a run: `fields.h5` with one group per step, `/step000000/{block}/{points,cells,natural_point,
/// <field>}`, so sizes may change from step to step, and `fields.xdmf`, which tells ParaView how to read it.
/// Both are complete after every step: a killed run leaves a readable pair. A table that is what it was at the step
/// before stands in the file once and has a name in each step. A dataset is named after its field without the unit
/// ("displacement [m]" -> "displacement"); the unit is its attribute "unit". Blocks without points on any rank are left
/// out.
class FieldsFile {
public:
  /// Creates the directory and the file. Throws UserError or MachineFailure on every rank if it cannot. Collective.
  FieldsFile(MPI_Comm comm, const std::filesystem::path& directory) : FieldsFile(comm, directory, 0) {}
  /// Goes on behind the first `steps` steps of the pair that is there; what follows them is dropped. Where that is not
  /// possible (a run killed while it wrote), the old file is put aside as fields_before.h5 and `fresh` is true: its
  /// first step is then number 0 again.
  FieldsFile(MPI_Comm comm, const std::filesystem::path& directory, int steps);
  bool fresh() const { return fresh_; }

  /// Adds one step. Blocks and fields have the same names and order on every rank; ranks may own no points.
  /// Throws std::logic_error on every rank if a size does not fit its block, MachineFailure if the disk refuses: the
  /// steps before are whole then. Collective.
  /// @param time time [s], or the load factor [-] of a static run
  void write(double time, std::span<const field::OutputBlock> blocks);
  int steps() const { return steps_; } ///< steps written so far
  /// Of the last step: bytes of places, cells and codes, which later steps share while nothing moves.
  std::int64_t bytes_that_stay() const { return staying_; }
  /// The end; all is on the disk itself then. Throws MachineFailure on every rank if the disk refuses. Collective.
  void close() { file_.close(); }

private:
  MPI_Comm comm_;
  std::filesystem::path directory_;
  bool fresh_;
  Hdf5File file_;
  int steps_ = 0;
  std::string xdmf_; ///< entries of all steps so far
  KeptTables kept_;
  std::int64_t staying_ = 0;
};
} // namespace pdx::io
