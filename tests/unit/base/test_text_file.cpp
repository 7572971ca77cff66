#include "pdx/base/error.hpp"
#include "pdx/base/text_file.hpp"
#include "support/refusal.hpp"
#include "support/scratch_directory.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace {
using namespace pdx;
using std::string_literals::operator""s;
using test::refusal;
using Words = std::vector<std::string_view>;

class TextFileTest : public testing::Test {
protected:
  std::filesystem::path written(const std::string& text) const
  {
    const std::filesystem::path path = scratch_.path() / "table.csv";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  /// The lines of a text, joined by |.
  std::string lines(const std::string& text) const
  {
    TextFile file("-table", written(text));
    std::string all;
    while (file.next()) all += "|" + std::string(file.line());
    return all;
  }
  std::string refusal_of(const std::filesystem::path& path) const
  {
    return refusal([&] { (void)TextFile("-table", path); });
  }
  test::ScratchDirectory scratch_{MPI_COMM_SELF};
};

TEST_F(TextFileTest, LinesEndInAnyWayAndTheMarkIsNoPartOfThem)
{
  for (const char* text : {"a\nb\n\nc", "a\r\nb\r\n\r\nc\r\n", "a\rb\r\rc\r",
                           "\xEF\xBB\xBF"
                           "a\nb\n\nc\n"})
    EXPECT_EQ(lines(text), "|a|b||c") << text;
  EXPECT_EQ(lines(""), "");
  EXPECT_EQ(lines("\xEF\xBB\xBF"), "");
  EXPECT_EQ(lines("\xEF"), "|\xEF");
}

TEST_F(TextFileTest, RefusalsNameFileLineAndWord)
{
  TextFile file("-table", written("1\n\n+5e-2 1.0 2.5 two nan 3e9\n"));
  while (file.number() < 3) ASSERT_TRUE(file.next());
  EXPECT_EQ(file.real("+5e-2"), 0.05);
  EXPECT_EQ(file.whole("1.0"), 1);
  EXPECT_TRUE(refusal([&] { (void)file.whole("2.5"); }).ends_with("csv, line 3: \"2.5\" is not a whole number"));
  EXPECT_TRUE(refusal([&] { (void)file.real("two"); }).ends_with("csv, line 3: \"two\" is not a number"));
  EXPECT_TRUE(refusal([&] { (void)file.real("nan"); }).ends_with("\"nan\" is not a finite number"));
  EXPECT_NE(refusal([&] { (void)file.real(""); }).find("an item is empty"), std::string::npos);
  EXPECT_NE(refusal([&] { (void)file.whole("3e9"); }).find("2147483647"), std::string::npos);
  EXPECT_LT(refusal([&] { (void)file.real(std::string(100000, 'x')); }).size(), 400u);
}

TEST_F(TextFileTest, WhatIsNoTextIsRefused)
{
  EXPECT_NE(refusal([&] { (void)lines("1\n2\0003\n"s); }).find("line 2: has the control character \\x00"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              (void)lines("\xFF\xFE"
                          "1\0"s);
            }).find("UTF-16"),
            std::string::npos);
  EXPECT_NE(refusal([&] { (void)lines(std::string(TextFile::kLongestLine + 1, 'x')); }).find("longer"),
            std::string::npos);
}

TEST_F(TextFileTest, WhatIsNoFileIsRefusedAndNeverWaitedFor)
{
  const std::filesystem::path pipe = scratch_.path() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_NE(refusal_of(pipe).find("pipe"), std::string::npos);
  EXPECT_NE(refusal_of("/dev/zero").find("device"), std::string::npos);
  EXPECT_NE(refusal_of(scratch_.path()).find("directory"), std::string::npos);
  EXPECT_NE(refusal_of(scratch_.path() / "nothing").find("no such file"), std::string::npos);
  EXPECT_NE(refusal_of(std::string(300, 'x')).find("cannot be read"), std::string::npos);
}

TEST(Words, StandBetweenBlanksOrOneComma)
{
  EXPECT_EQ(words_of(" 0 0.5, 1\t2,3 # note"), (Words{"0", "0.5", "1", "2", "3"}));
  EXPECT_EQ(words_of("1,,2"), (Words{"1", "", "2"}));
  EXPECT_EQ(words_of(",1"), (Words{"", "1"}));
  EXPECT_EQ(words_of("1,"), (Words{"1", ""}));
  EXPECT_EQ(words_of(" # note"), Words{});
}

TEST(Cells, StandBetweenCommas)
{
  EXPECT_EQ(cells_of(" a b ,\t2,"), (Words{"a b", "2", ""}));
  EXPECT_EQ(cells_of(""), Words{""});
}
} // namespace
