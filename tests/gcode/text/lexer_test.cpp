#include "gcode/text/lexer.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace stratum::gcode {
namespace {

// A line as text: commands in <>, parameters in order of the alphabet, '?' for one without a number, the comment
// behind '|', '!' if something was unreadable.
std::string show(const Line& line) {
    std::string text;
    for (std::size_t i = 0; i < line.count; ++i) {
        const Command& command = line.commands[i];
        text += '<';
        if (command.kind == Command::Kind::extended) text += command.name;
        if (command.kind == Command::Kind::foreign) text += fmt::format("~{}", command.name);
        if (command.kind == Command::Kind::numbered) {
            text += fmt::format("{}{}", command.letter, command.code);
            if (command.subcode != 0) text += fmt::format(".{}", command.subcode);
        }
        for (char letter = 'A'; letter <= 'Z'; ++letter)
            if (command.has(letter))
                text += command.hasValue(letter)       ? fmt::format(" {}{}", letter, command.value(letter))
                        : command.isExpression(letter) ? fmt::format(" {}{{}}", letter)
                                                       : fmt::format(" {}?", letter);
        text += '>';
    }
    if (!line.comment.empty()) text += fmt::format("|{}", line.comment);
    if (line.unreadable) text += '!';
    if (line.deleted) text += '/';
    return text;
}

std::vector<std::string> lex(std::string_view bytes) {
    Lexer lexer(bytes);
    std::vector<std::string> lines;
    Line line;
    while (lexer.next(line)) {
        lines.push_back(show(line));
        EXPECT_EQ(line.number, lines.size());
    }
    EXPECT_EQ(lexer.offset(), bytes.size());
    return lines;
}

struct LexedLine {
    std::string_view source;
    std::string_view expected;
};

class LexerLine : public testing::TestWithParam<LexedLine> {};

TEST_P(LexerLine, ReadsAs) {
    const auto lines = lex(GetParam().source);
    ASSERT_EQ(lines.size(), 1U);
    EXPECT_EQ(lines[0], GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Table, LexerLine,
    testing::Values(
        LexedLine{"G1 X1.5 Y-2 E.3 F1800", "<G1 E0.3 F1800 X1.5 Y-2>"}, LexedLine{"G1X1Y2E.3", "<G1 E0.3 X1 Y2>"},
        LexedLine{"g1 x1 y2", "<G1 X1 Y2>"}, LexedLine{"G01 X1", "<G1 X1>"}, LexedLine{"G 1 X 10 Y 20", "<G1 X10 Y20>"},
        LexedLine{"\tG1\tX1 \t", "<G1 X1>"}, LexedLine{"G1 X1E5", "<G1 E5 X1>"}, LexedLine{"G92.1", "<G92.1>"},
        LexedLine{"N12 G1 X3*85", "<G1 X3>"}, LexedLine{"N12G1X3 *85", "<G1 X3>"}, LexedLine{"n7 M82", "<M82>"},
        LexedLine{"N5", ""}, LexedLine{"N3 T0*57", "<T0>"}, LexedLine{"T1", "<T1>"}, LexedLine{"T-1", "<T-1>"},
        LexedLine{"T?", "<T-1>"}, LexedLine{"Tx ; t", "<T-1>| t"}, LexedLine{"T12 ; tool", "<T12>| tool"},
        LexedLine{"M104 T1 S200", "<M104 S200 T1>"}, LexedLine{"M84 X Y E", "<M84 E? X? Y?>"},
        LexedLine{"G28 X", "<G28 X?>"}, LexedLine{"X1 Y2", "< X1 Y2>"}, LexedLine{"F1200", "< F1200>"},
        LexedLine{"G21 G90", "<G21><G90>"}, LexedLine{"G53 G0 X1", "<G53><G0 X1>"}, LexedLine{"M11P1", "<M11 P1>"},
        LexedLine{"M200 D1.75nG28", "<M200 D1.75 N?><G28>"},  // a slicer's literal n for a line end
        LexedLine{"; only this", "| only this"}, LexedLine{";", ""}, LexedLine{"(a) G1 X1 (b)", "<G1 X1>|a"},
        LexedLine{"G1 (mid) X1", "<G1 X1>|mid"}, LexedLine{"G1 X1 (open", "<G1 X1>|open"},
        LexedLine{"G0 X1;(Go)", "<G0 X1>|(Go)"}, LexedLine{"G1 X1 ; a ; b", "<G1 X1>| a ; b"}, LexedLine{"%", ""},
        LexedLine{"M117 G1 X5 (no)", "<M117>"}, LexedLine{"M117 Hi ; c", "<M117>| c"},
        LexedLine{"M23 file.gco", "<M23>"}, LexedLine{"M862.3 P \"MK3S\"", "<M862.3 P?>"},
        LexedLine{"M862.6 P\"Input shaper\" ; x", "<M862.6 P?>| x"}, LexedLine{"M551 P\"a;b", "<M551>|b"},
        LexedLine{"PRINT_START BED=110", "<PRINT_START>"}, LexedLine{"print_end ; bye", "<print_end>| bye"},
        LexedLine{"SET_PIN PIN=a VALUE=1", "<SET_PIN>"}, LexedLine{"G1 Xnan", "<G1 A? N? X?>"},
        LexedLine{"G1 X--5", "<G1 X?>!"}, LexedLine{"G1 X1.2.3", "<G1 X1.2>!"}, LexedLine{"G1 X1 \xC3\xA9", "<G1 X1>!"},
        LexedLine{"123", "!"}, LexedLine{"@pause", "<pause>!"}, LexedLine{"M109 S[temp] T0", "<M109 S{} T0>"},
        LexedLine{"\xEF\xBB\xBFG1 X1", "<G1 X1>"}, LexedLine{"G99999999999999999999", "<G9999999>"}));

INSTANTIATE_TEST_SUITE_P(TextIsNoCommand, LexerLine,
                         testing::Values(LexedLine{"M486 AGlock g19 mag.stl", "<M486>"},
                                         LexedLine{"M486 A\"gear; G28.stl\" ; c", "<M486>| c"},
                                         LexedLine{"M486 S1 Abox_G1_X99.stl", "<M486 S1>"},
                                         LexedLine{"M486 T2", "<M486 T2>"}, LexedLine{"M1 use g92 X5", "<M1>"},
                                         LexedLine{"M0 click", "<M0>"}, LexedLine{"M98 P/macros/g28.g", "<M98>"},
                                         LexedLine{"M810 G1 X5 E5", "<M810>"},
                                         LexedLine{"M1002 judge_flag g29_before_print_flag", "<M1002>"},
                                         LexedLine{"M1006 A0 B10 L100 C37 D10 M60 E37 F10 N60", "<M1006>"},
                                         LexedLine{"M820 G1 X5", "<M820><G1 X5>"}));

INSTANTIATE_TEST_SUITE_P(Foreign, LexerLine,
                         testing::Values(LexedLine{"Q603 MINX-37.50 MAXY5", "<~Q603 A? I? M? N? Q603 X? Y5>"},
                                         LexedLine{"S1000 X5", "<~S1000 S1000 X5>"}, LexedLine{"G X5", "<~G G? X5>"},
                                         LexedLine{"Y5 E1", "< E1 Y5>"}, LexedLine{"I1 J2 X3", "< I1 J2 X3>"},
                                         LexedLine{"/ G1 X50", "/"}, LexedLine{"// G1 X50", ""},
                                         LexedLine{"N4 /G1 X50", "/"}, LexedLine{"G1 X5 / 2", "<G1 X5>!"}));

INSTANTIATE_TEST_SUITE_P(Expressions, LexerLine,
                         testing::Values(LexedLine{"G1 F{60*var.x2}", "<G1 F{}>"},
                                         LexedLine{"G1 X{move.axes[0].max - 5} Y3 E{a{1}}", "<G1 E{} X{} Y3>"},
                                         LexedLine{"G1 X{open Y5", "<G1 X{}>"}, LexedLine{"G1 X{1} X2", "<G1 X2>"}));

TEST(Lexer, LineEndsOfEveryKind) {
    EXPECT_EQ(lex("G1\nG2\r\nG3\rG4"), (std::vector<std::string>{"<G1>", "<G2>", "<G3>", "<G4>"}));
    EXPECT_EQ(lex("G1\r\r\nG2\n\n"), (std::vector<std::string>{"<G1>", "", "<G2>", ""}));
    EXPECT_EQ(lex("G1 ; a\r; b\r"), (std::vector<std::string>{"<G1>| a", "| b"}));
    EXPECT_TRUE(lex("").empty());
}

TEST(Lexer, FreeTextIsKept) {
    Lexer lexer("M117 Hello G1\nEXCLUDE_OBJECT_START NAME=a_1 ; x\nM486 S3 T4\nM486 S3 Ag28 b.stl;c");
    Line line;
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].text, " Hello G1");
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].text, " NAME=a_1 ");
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].text, " S3 T4");
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].text, " S3 Ag28 b.stl");
}

TEST(Lexer, AParameterOfAnEarlierLineIsForgotten) {
    Lexer lexer("G1 X1 Y2\nG1 Z3");
    Line line;
    ASSERT_TRUE(lexer.next(line));
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(show(line), "<G1 Z3>");
}

TEST(Lexer, TooManyCommandsInALineAreBounded) {
    std::string text;
    for (std::size_t n = 0; n < Line::kMaxCommands + 2; ++n) text += "G1 ";
    text += "X1";
    Lexer lexer(text);
    Line line;
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.count, Line::kMaxCommands);
    EXPECT_TRUE(line.unreadable);
}

// As machine tools have it.
TEST(Lexer, FiveCommandsInALine) {
    Lexer lexer("G21 G90 G17 M83 G92 E0");
    Line line;
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(show(line), "<G21><G90><G17><M83><G92 E0>");
    EXPECT_FALSE(line.unreadable);
}

TEST(Lexer, ALineOfAMegabyte) {
    std::string text = "; ";
    text.append(1 << 20, 'x');
    text.append("\nG1 X1");
    const auto lines = lex(text);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[1], "<G1 X1>");
}

TEST(Lexer, ParenthesesInParentheses) {
    EXPECT_EQ(lex("G1 (a (b) c) X1 (d)"), (std::vector<std::string>{"<G1 X1>|a (b) c"}));
    EXPECT_EQ(lex("G1 (a (b) X1"), (std::vector<std::string>{"<G1 X1>|a (b"}));  // not balanced: as RS274 has it
    EXPECT_EQ(lex("G1 X1 (a"), (std::vector<std::string>{"<G1 X1>|a"}));
    const std::string many(1 << 20, '(');
    EXPECT_EQ(lex(many + ")G1").size(), 1U);  // in linear time
}

TEST(Lexer, DecimalCommas) {
    Lexer lexer("G1 X1,5 Y2\nG1 X1, Y2\nG1 X1.5");
    Line line;
    for (const bool comma : {true, false, false}) {
        ASSERT_TRUE(lexer.next(line));
        EXPECT_EQ(line.decimal_comma, comma) << line.number;
    }
}

TEST(Lexer, RowsOfAPictureAreNoWords) {
    Lexer lexer("W220 0e1f E5 X2\nW221\nW-5 X1");
    Line line;
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].kind, Command::Kind::foreign);
    EXPECT_FALSE(line.commands[0].has('E'));
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].kind, Command::Kind::foreign);
    ASSERT_TRUE(lexer.next(line));
    EXPECT_EQ(line.commands[0].kind, Command::Kind::words);
}

}  // namespace
}  // namespace stratum::gcode
