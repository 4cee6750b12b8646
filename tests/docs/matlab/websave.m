function name = websave (name, url)
  % Octave has urlwrite for it.
  urlwrite (url, name);
end
