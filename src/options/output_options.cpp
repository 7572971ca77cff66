#include "pdx/options/scene_options.hpp"

#include "pdx/base/error.hpp"

#include <algorithm>
#include <filesystem>

namespace pdx::options {
OutputOptions OutputOptions::read(const std::string& case_name, bool dynamic)
{
  Options o("output");
  OutputOptions output;
  output.directory = o.text("-output_dir", "out/" + case_name, "directory for all files");
  output.pictures = output.fields = o.boolean("-output_fields", false, "write fields.h5 and fields.xdmf for ParaView");
  static constexpr const char* formats[] = {"xdmf", "vtkhdf"};
  output.vtkhdf = o.choice("-output_format", 0, formats,
                           "what shows fields.h5: fields.xdmf; vtkhdf: fields_BLOCK.vtkhdf of each block too, at the "
                           "end of the run (ParaView 5.12 and newer)") == 1;
  if (output.vtkhdf && !output.pictures)
    throw UserError("-output_format vtkhdf is how fields are shown: give -output_fields too");
  output.dry_run = o.boolean("-dry_run", false,
                             "read, judge and build all, write the initial fields into the directory dry_run below "
                             "-output_dir, time some steps (static: a solve), tell what the run would take, and end");
  output.times =
      o.reals("-output_times", {}, 0, "s", "in time: fields at the steps nearest to these times", Range::positive());
  std::ranges::sort(output.times);
  const int usual = !dynamic ? 1 : output.times.empty() ? 100 : 1000000000;
  output.interval = o.integer("-output_interval", usual,
                              "accepted steps between fields (in time: 100, with -output_times none); the last step is "
                              "always written",
                              {1.0, 1e9});
  output.history = o.boolean("-output_history", false, "write history.csv");
  output.history_interval = o.integer("-output_history_interval", dynamic ? 10 : 1,
                                      "accepted steps between rows of history.csv (in time: 10)", {1.0, 1e9});
  output.warnings_are_errors =
      o.boolean("-warnings_are_errors", false, "a warning ends the run with status 1, for batches");
  output.quiet = o.boolean("-quiet", false, "no progress");
  if (output.dry_run) {
    output.directory = (std::filesystem::path(output.directory) / "dry_run").string();
    output.fields = true;
  }
  return output;
}
} // namespace pdx::options
