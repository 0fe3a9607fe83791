/* config.h - the colour configuration that is built into the program (meniscus.ocio).
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_CONFIG_H
#define MEN_CONFIG_H

/* Its lines, each with its end of line; NULL behind the last. (One string would be longer than C promises.) */
extern const char *const color_config_lines[];

#endif
