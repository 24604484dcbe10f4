#!/usr/bin/perl
# SPDX-License-Identifier: BSD-3-Clause
# Prints a document of the repository as Doxygen 1.9 takes it: identifiers of headings and links to them, images by name
# (all are in one folder), links to public headers as references, and other files of the sources as their paths.
#   scripts/docs/for_doxygen.pl DOCUMENT PUBLIC_HEADERS...     paths relative to the current folder, the root
use strict;
use warnings;
use File::Basename;

my ($document, @headers) = @ARGV;
my %is_public = map { $_ => 1 } @headers;

# "bench/README.md" -> "doc_bench_README", with the heading "Exit status" -> "doc_bench_README_exit-status"
sub page_id { my $path = shift; $path =~ s/\.md$//; $path =~ s/[^A-Za-z0-9]/_/g; return "doc_$path"; }
sub anchor { my $heading = lc shift; $heading =~ s/`//g; $heading =~ s/[^a-z0-9 _-]//g; $heading =~ s/ /-/g; return $heading; }

# The path of a link relative to the root, without "." and "..".
sub path_of {
  my @parts;
  for my $part (split m{/}, dirname($document) . "/" . shift) {
    next if $part eq "" || $part eq ".";
    if ($part eq "..") { pop @parts } else { push @parts, $part }
  }
  return join "/", @parts;
}

sub link_text {
  my ($is_image, $text, $target) = @_;
  return "$is_image\[$text]($target)" if $target =~ m{^https?:};
  my ($file, $heading) = split /#/, $target;
  my $path = $file eq "" ? $document : path_of($file);
  return "$is_image\[$text](" . basename($path) . ")" if $path =~ /\.(svg|png|jpg)$/;
  if ($path =~ /\.md$/) { return "\@ref " . page_id($path) . ($heading ? "_$heading" : "") . " \"$text\""; }
  return "\@ref $path \"$text\"" if $is_public{$path};
  return basename($path) eq $text ? "`$path`" : "$text (`$path`)";
}

open my $input, "<", $document or die "$document: $!";
my $is_code = 0;
my $has_title = 0;
while (my $line = <$input>) {
  $is_code = !$is_code if $line =~ /^\s*```/;
  # Doxygen knows no "console".
  $line =~ s/```console/```/;
  if (!$is_code && $line =~ /^(#+) (.*)$/) {
    $line = "$1 $2 {#" . page_id($document) . ($has_title ? "_" . anchor($2) : "") . "}\n";
    $has_title = 1;
  } elsif (!$is_code) {
    $line =~ s/(!?)\[((?:`[^`]*`|[^\]`])*)\]\(([^)]+)\)/link_text($1, $2, $3)/ge;
    $line =~ s/src="([^":]+)"/'src="' . basename($1) . '"'/ge;
    $line =~ s/`::([a-z_]+)`/<tt>&#58;:$1<\/tt>/g;
  }
  print $line;
}
