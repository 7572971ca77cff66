#include "pdx/app/scene_options.hpp"

#include <algorithm>

namespace pdx::app {
OutputOptions OutputOptions::read(const std::string& case_name, bool dynamic)
{
  Options o("output");
  OutputOptions output;
  output.directory = o.text("-output_dir", "out/" + case_name, "directory for all files");
  output.fields = o.boolean("-output_fields", false, "write fields.h5 and fields.xdmf for ParaView");
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
  output.quiet = o.boolean("-quiet", false, "no progress");
  return output;
}
} // namespace pdx::app
