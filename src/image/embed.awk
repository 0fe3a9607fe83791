# embed.awk - turns the built-in colour configuration into a C array of its lines.
# awk -f src/image/embed.awk src/image/meniscus.ocio > ocio_config.c
# SPDX-License-Identifier: Apache-2.0
BEGIN {
    print "/* Generated from src/image/meniscus.ocio by src/image/embed.awk. */"
    print "#include \"image/config.h\"\n"
    print "const char *const color_config_lines[] = {"
}
{
    gsub(/\\/, "&&")
    gsub(/"/, "\\\\&")
    print "    \"" $0 "\\n\","
}
END { print "    0,\n};" }
