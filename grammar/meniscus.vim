" meniscus.vim - the scene language of meniscus, for Vim. Made from the tables: make man.
" Copy it to ~/.vim/syntax/ and have: autocmd BufRead,BufNewFile *.mns setfiletype meniscus
if exists('b:current_syntax')
  finish
endif
syntax case match
syntax iskeyword @,48-57,_,192-255
syntax keyword meniscusKeyword and as by children def defaults else for if in include let not or param use var while
syntax keyword meniscusConstant false none true clock frame frames time x y z pi
syntax match meniscusChoice /\<\%(solid\|liquid\|gas\|plain\|checker\|aluminium\|brass\|bronze\|chromium\|copper\|gold\|green_gold\|iron\|nickel\|palladium\|platinum\|rhodium\|silver\|stainless_steel\|titanium\|around\|x\|y\|z\|up\|down\|uv\|planar\|box\|cylindrical\|spherical\|repeat\|clamp\|mirror\|once\|mean\|red\|green\|blue\|alpha\|object\|world\|linear\|radial\|ramp\|triangle\|sine\|scallop\|smooth\|turbulence\|ridged\|border\|distance\|cell\|cubic\|natural\|bezier\|flat\|round\|left\|center\|right\|quad\|disc\|sphere\|distant\|point\|spot\|portal\|clear\|overcast\|perspective\|orthographic\|panorama\|fisheye\|tent\|albedo\|normal\|depth\|position\|medium\|nesting\|samples\|variance\|cryptomatte\|spectrum\|lights\|behind_albedo\|behind_normal\|behind_depth\|behind_position\|behind_uv\|behind_object\|behind_medium\|behind_cryptomatte\|automatic\|entered\|priority\|none\|on\|off\|spread\|keep\)\>/
syntax match meniscusFunction /\<\%(sin\|cos\|tan\|asin\|acos\|atan\|atan2\|sqrt\|abs\|floor\|ceil\|round\|frac\|sign\|exp\|log\|log10\|pow\|mod\|min\|max\|clamp\|mix\|smoothstep\|spline\|natural_spline\|angle\|length\|distance\|normalize\|dot\|cross\|len\|sum\|product\|sort\|reverse\|vec2\|vec3\|vec4\|rgb\|srgb\|hsv\|hsl\|rnd\|noise\|rotate\|translate\|scale\|matrix\|transform\|inverse\|apply\|align\|bounds\|inside\|hit\|hits\|scatter\|volume\|str\|text\|print\|warn\|assert\|cauchy\|sellmeier\|hg\|draine\|two_hg\|rayleigh\|droplets\|bubbles\|spheres\|measured\|blackbody\|spectrum\)\ze\s*(/
syntax match meniscusNode /\<\%(medium\|volume\|world\|surface\|image\|formula\|checker\|brick\|hexagon\|gradient\|noise\|marble\|wood\|granite\|crackle\|spots\|agate\|mix\|variation\|sphere\|ellipsoid\|torus\|box\|cylinder\|capsule\|cone\|lathe\|mesh\|prism\|sweep\|superellipsoid\|height_field\|plane\|text\|blob\|isosurface\|ground\|group\|union\|merge\|intersection\|difference\|light\|environment\|camera\|film\|render\|animation\|preset\)\>\ze\%(\s\+\k\+\)\=\s*{/
syntax match meniscusProperty /\<\%(ior\|extraordinary_ior\|optic_axis\|absorption\|tint\|depth\|extraordinary_absorption\|extraordinary_tint\|scattering\|phase\|density\|emission\|radiance\|temperature\|light_group\|mixes\|state\|priority\|file\|grid\|function\|from\|to\|cells\|scale\|medium\|albedo\|pattern\|albedo2\|check_size\|diffuse_roughness\|specular\|roughness\|metal\|metalness\|anisotropy\|grain\|grain_angle\|thin\|transmission\|film\|film_ior\|translucency\|coat\|coat_ior\|coat_roughness\|coat_anisotropy\|coat_tint\|fuzz\|fuzz_color\|fuzz_roughness\|mix\|weight\|bump\|bump_height\|normal_map\|normal_strength\|normal_y\|shadow_catcher\|colorspace\|projection\|turns\|wrap\|channel\|clip\|ramp\|space\|vary\|turbulence\|turbulence_octaves\|seed\|size\|mortar\|bevel\|bond\|shape\|wave\|frequency\|style\|octaves\|lacunarity\|gain\|value\|radius\|blur\|blend\|center\|strength\|interior\|surface\|radii\|tube\|bevel_segments\|rounding\|radius_from\|radius_to\|profile\|curve\|corners\|tolerance\|smooth\|part\|unit\|up\|next_file\|positions\|triangles\|closed\|weld\|crease\|outline\|scale_from\|scale_to\|path\|outline_curve\|ends\|twist\|segments\|exponents\|image\|heights\|base\|normal\|distance\|text\|font\|align\|letter_spacing\|line_spacing\|threshold\|y\|angle\|color\|intensity\|power\|visible\|resolution\|sky\|elevation\|azimuth\|turbidity\|ground\|disc\|fov\|upright\|shift\|width\|aperture\|blades\|blade_rotation\|blade_roundness\|focus\|shutter\|shutter_steps\|expect\|filter\|output\|exposure\|auto_exposure\|white_balance\|alpha\|aovs\|samples\|adaptive\|noise\|bounces\|dispersion\|nesting\|caustics\|fireflies\|denoise\|frames\|first_frame\|fps\|cyclic\)\>\ze\s*=[^=]/
syntax match meniscusHeader /\%^\_s*meniscus\s\+[0-9.]\+\%(\s\+unit\s\+\k\+\)\=/
syntax match meniscusNumber /\%(\<\d\+\%(\.\.\@!\d*\)\=\|\.\@1<!\.\d\+\)\%([eE][-+]\=\d\+\)\=\%(nm\|um\|mm\|cm\|m\|km\|in\|ft\|deg\|rad\|turn\|ms\|s\|K\)\=\k\@!/
syntax match meniscusColor /#\x\{6}\|#\x\{3}/
syntax match meniscusEscape /\\\%(["\\nt]\|u{\x\+}\)/ contained
syntax region meniscusString start=/"/ skip=/\\./ end=/"/ oneline contains=meniscusEscape
syntax match meniscusComment ;//.*$;
syntax region meniscusComment start=;/\*; end=;\*/; contains=meniscusComment
highlight default link meniscusHeader PreProc
highlight default link meniscusKeyword Statement
highlight default link meniscusConstant Constant
highlight default link meniscusChoice Constant
highlight default link meniscusFunction Function
highlight default link meniscusNode Type
highlight default link meniscusProperty Identifier
highlight default link meniscusNumber Number
highlight default link meniscusColor Number
highlight default link meniscusEscape SpecialChar
highlight default link meniscusString String
highlight default link meniscusComment Comment
let b:current_syntax = 'meniscus'
