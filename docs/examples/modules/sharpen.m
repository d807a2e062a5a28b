% SPDX-License-Identifier: GPL-3.0-or-later
% A module: sharpens with the mean of the four neighbours (GNU Octave). todbench module check "octave-cli sharpen.m"
1;
function [header, numbers] = read_message()
  start = fread(stdin, 10, "uint8=>uint8");
  if numel(start) < 10, exit(0); end
  text = fread(stdin, double(start(9)) + 256 * double(start(10)), "uint8=>uint8");
  header = [start; text];
  shape = str2double(strsplit(regexp(char(text'), "'shape': \\(([^)]*)\\)", "tokens"){1}{1}, ","));
  shape = shape(!isnan(shape));
  if any(strfind(char(text'), "<f4"))
    numbers = reshape(fread(stdin, prod(shape), "single=>single"), fliplr(shape))';  % rows first
  else
    numbers = fread(stdin, prod(shape), "uint8=>uint8");
  end
end

read_message();  % JSON: what the stage is to do
while true
  [header, p] = read_message();
  p = p([1 1:end end], [1 1:end end]);
  out = 2 * p(2:end-1, 2:end-1) - (p(1:end-2, 2:end-1) + p(3:end, 2:end-1) + p(2:end-1, 1:end-2) + p(2:end-1, 3:end)) / 4;
  fwrite(stdout, header, "uint8");  % the same type and shape
  fwrite(stdout, out', "single");
  fflush(stdout);
end
