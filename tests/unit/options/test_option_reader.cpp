#include "pdx/options/option_reader.hpp"
#include "support/refusal.hpp"
#include "support/scratch_directory.hpp"

#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>

namespace {
using namespace pdx;
using std::string_literals::operator""s;

class OptionReaderTest : public testing::Test {
protected:
  std::string file(const std::string& name, const std::string& text) const
  {
    std::ofstream(scratch_.path() / name, std::ios::binary) << text;
    return (scratch_.path() / name).string();
  }
  /// What was read from these words, as "name=value" joined by blanks.
  static std::string read(const std::vector<std::string>& words)
  {
    options::OptionReader reader;
    reader.read_command_line(words);
    std::string all;
    for (const GivenOption& option : reader.take())
      all += fmt::format("{}{}={}", all.empty() ? "" : " ", option.name, option.value);
    return all;
  }
  std::string read_text(const std::string& text) const { return read({"-options_file", file("case.opts", text)}); }
  static std::string refusal(const std::vector<std::string>& words)
  {
    return test::refusal([&] { (void)read(words); });
  }
  /// Behind the name of the file.
  std::string refusal_of(const std::string& text) const
  {
    const std::string what = test::refusal([&] { (void)read_text(text); });
    const std::size_t at = what.find("case.opts, ");
    return at == std::string::npos ? what : what.substr(at + 11);
  }
  test::ScratchDirectory scratch_{MPI_COMM_SELF};
};

TEST_F(OptionReaderTest, TakesLinesAsPeopleWriteThem)
{
  const std::string right = "-a=1 -b= -c=-2,3";
  for (const char* text : {"-a 1\n-b\n-c -2,3\n", "-a 1\r\n-b\r\n-c -2,3", "-a 1\r-b\r-c -2,3\r",
                           "\xEF\xBB\xBF-a 1\n\n# note\n\t-b # note\n  -c   -2, 3\t\n", "-a '1'\n-b\n-c -2 , 3\n",
                           "-a 1\n-b\n-c -2 ,3 # 4\n"})
    EXPECT_EQ(read_text(text), right) << text;
  EXPECT_EQ(read_text(""), "");
  EXPECT_EQ(read_text("-case \"my own # case\"\n"), "-case=my own # case");
  EXPECT_EQ(read_text("-name '-abc'\n"), "-name=-abc");
}

TEST_F(OptionReaderTest, NamesLineAndWordOfAFault)
{
  const auto expect = [&](const std::string& text, const std::string& begin) {
    const std::string what = refusal_of(text);
    EXPECT_TRUE(what.starts_with(begin)) << what;
    EXPECT_LT(what.size(), 400u);
  };
  expect("-a 0,0\n-b 1,1 junk\n", "line 2: \"junk\" is one word too many after -b 1,1: ");
  expect("-a 1e9 [Pa]\n", "line 1: \"[Pa]\" is one word too many");
  expect("-a 1e5 0\n", "line 1: \"0\" is one word too many");
  expect("-a 1 ! note\n", "line 1: \"!\" is one word too many");
  expect("-a 1 -b 2\n", "line 1: \"-b\" is a second option on the line of -a");
  expect("-a = 1\n", "line 1: -a = ...: drop the sign =");
  expect("-a=1\n", "line 1: \"-a=1\": write a blank instead of =");
  expect("a 1\n", "line 1: \"a\" is no option: a line is -name value, or # comment");
  expect("-a 4,4#note\n", "line 1: \"4,4#note\": put a blank before #");
  expect("-a 'b\n", "line 1: 'b begins a quote that does not end");
  expect("-a 'b'c\n", "line 1: \"c\" follows a quote without a blank");
  expect("\n-a 1\0\n"s, "line 2: has the control character \\x00");
  expect("-options_file\n", "line 1: -options_file has no value");
  expect("-options_file_yaml a\n", "line 1: -options_file_yaml: YAML is not read");
  expect("-options_file nowhere.opts\n", "line 1: -options_file nowhere.opts: there is no such file");
  expect("-prefix_push a_\n", "line 1: -prefix_push a_ has no -prefix_pop");
  expect("-prefix_pop\n", "line 1: -prefix_pop has no -prefix_push");
  expect("-" + std::string(5000, 'a') + " 1\n", "line 1: \"-aaa");
  expect("-a " + std::string(5000, 'b') + " c\n", "line 1: \"c\" is one word too many after -a bbb");
}

TEST_F(OptionReaderTest, RefusesStraysOnTheCommandLine)
{
  EXPECT_TRUE(refusal({"stray"}).starts_with("\"stray\" on the command line is no option"));
  EXPECT_TRUE(refusal({"-a", "1", "2"}).starts_with("\"2\" is one word too many after -a 1: "));
  EXPECT_NE(refusal({"-options_file", file("a.opts", ""), "b.opts"}).find("each file has its own -options_file"),
            std::string::npos);
  EXPECT_NE(refusal({"-a", "b\nc"}).find("control character"), std::string::npos);
  EXPECT_NE(refusal({"-options_file"}).find("has no value"), std::string::npos);
  EXPECT_NE(refusal({"-options_file", "a.yaml"}).find("YAML"), std::string::npos);
  EXPECT_NE(refusal({"-options_file", "/dev/zero"}).find("device"), std::string::npos);
  EXPECT_NE(refusal({"-version", "me"}).find("\"me\" is one word too many"), std::string::npos);
}

TEST_F(OptionReaderTest, ValuesMayBeNegativeNumbersAndListsMayHaveBlanks)
{
  EXPECT_EQ(read({"-a", "-1", "-b", "-.5,", "-1e3", "-c"}), "-a=-1 -b=-.5,-1e3 -c=");
  EXPECT_EQ(read({"-a", "-inf"}), "-a=-inf");
}

TEST_F(OptionReaderTest, FilesStandWhereTheyAreNamedAndMayNameOthers)
{
  const std::string inner = file("in ner.opts", "-b 2\n"),
                    outer = file("outer.opts", "-a 1\n-options_file '" + inner + "'\n-c 3\n");
  EXPECT_EQ(read({"-a", "0", "-options_file", outer, "-c", "4"}), "-a=0 -a=1 -b=2 -c=3 -c=4");
  const std::string circle = file("circle.opts", "-options_file " + (scratch_.path() / "circle.opts").string() + "\n");
  EXPECT_NE(refusal({"-options_file", circle}).find("circle"), std::string::npos);
}

TEST_F(OptionReaderTest, PrefixesStandBeforeNames)
{
  EXPECT_EQ(read_text("-prefix_push mg_\n-prefix_push levels_\n-pc_type sor\n-prefix_pop\n-x 1\n-prefix_pop\n-y 2\n"),
            "-mg_levels_pc_type=sor -mg_x=1 -y=2");
}

TEST_F(OptionReaderTest, TellsWhereOptionsStand)
{
  options::OptionReader reader;
  reader.read_environment("PETSC_OPTIONS", "-ksp_rtol 1e-8");
  const std::string path = file("case.opts", "\n-a 1\n");
  reader.read_command_line(std::vector<std::string>{"-options_file", path, "-b", "2"});
  const auto options = reader.take();
  ASSERT_EQ(options.size(), 3u);
  EXPECT_EQ(options[0].place, "PETSC_OPTIONS");
  EXPECT_EQ(options[1].place, path + ", line 2");
  EXPECT_EQ(options[2].place, "");
}

TEST_F(OptionReaderTest, OfTheEnvironmentTheVariableIsNamed)
{
  options::OptionReader reader;
  const auto refusal = [&](const char* text) {
    return test::refusal([&] { reader.read_environment("PETSC_OPTIONS", text); });
  };
  EXPECT_EQ(refusal("ksp"), "PETSC_OPTIONS: \"ksp\" is no option: options are -name value");
  EXPECT_EQ(refusal("-a 'b"), "PETSC_OPTIONS: 'b begins a quote that does not end");
  EXPECT_TRUE(refusal("-options_file nowhere").starts_with("PETSC_OPTIONS: -options_file nowhere: there is no"));
}

TEST(GivenOptions, AMessageNamesThePlaceOfItsOption)
{
  give_option({"-mesh_cells", "4", "case.opts, line 3"});
  give_option({"-case", "x", ""});
  EXPECT_EQ(with_place("-mesh_cells is \"4\": must be two"), "case.opts, line 3: -mesh_cells is \"4\": must be two");
  EXPECT_EQ(with_place("-case is \"x\": no"), "-case is \"x\": no");
  EXPECT_EQ(with_place("-mesh_file: give -mesh_cells"), "-mesh_file: give -mesh_cells");
  take_back_option("-mesh_cells");
  take_back_option("-case");
}
} // namespace
